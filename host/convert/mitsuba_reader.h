// A Mitsuba scene while it is read: its XML with includes and parameters, and what its parts share.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <pugixml.hpp>

#include "host/convert/described.h"
#include "host/convert/spectrum.h"

namespace wavepath::convert {

struct MitsubaDocument {
  std::string path;
  std::vector<std::uint8_t> text;
  pugi::xml_document xml;
};

struct MitsubaReader {
  std::vector<std::unique_ptr<MitsubaDocument>> documents;
  std::map<std::string, std::string> parameters; // of <default>
  std::vector<std::filesystem::path> folders;    // that files are looked for in
  std::map<std::string, pugi::xml_node> ids;
  Description scene;
  std::map<std::string, std::uint32_t> meshes, materials, groups;          // by what they were made of
  int depth = 0;                                                           // of nested BSDFs and textures
  mutable std::map<std::size_t, std::set<std::string, std::less<>>> asked; // by element: names looked for in it
};

// mitsuba_xml.cpp
[[noreturn]] void fail_at(const MitsubaReader& reader, const pugi::xml_node& node, const std::string& problem,
                          const std::string& remedy = "correct the file");
// The elements of the scene and of the files that it includes, in order.
std::vector<pugi::xml_node> read_elements(MitsubaReader& reader, const std::string& path);
// An attribute, with parameters replaced by their values.
std::string attribute(const MitsubaReader& reader, const pugi::xml_node& node, const char* name);
// The child with this name="", whatever its tag; a <ref> leads to what it means. Empty if there is none.
pugi::xml_node named_child(const MitsubaReader& reader, const pugi::xml_node& node, std::string_view name);
// Names among the losses the values of an element that nothing has looked for, once.
void tell_unused(MitsubaReader& reader, const pugi::xml_node& node);
// What an element means: itself, or the target of a <ref>.
pugi::xml_node resolved(const MitsubaReader& reader, const pugi::xml_node& node);
// Children of a tag, and references to such.
std::vector<pugi::xml_node> children_of(const MitsubaReader& reader, const pugi::xml_node& node, std::string_view tag);
std::vector<double> numbers_of(const MitsubaReader& reader, const pugi::xml_node& node, const std::string& text);
double read_float(const MitsubaReader& reader, const pugi::xml_node& node, std::string_view name, double otherwise);
bool read_bool(const MitsubaReader& reader, const pugi::xml_node& node, std::string_view name, bool otherwise);
std::string read_text(const MitsubaReader& reader, const pugi::xml_node& node, std::string_view name,
                      const std::string& otherwise);
// A file beside the scene, or in one of its folders.
std::string read_path(const MitsubaReader& reader, const pugi::xml_node& node, const std::string& name);
glm::dvec3 read_vector(const MitsubaReader& reader, const pugi::xml_node& node, std::string_view name,
                       const glm::dvec3& otherwise);
// The <transform> of that name.
glm::dmat4 read_transform(MitsubaReader& reader, const pugi::xml_node& node, std::string_view name = "to_world");

// mitsuba_values.cpp
enum class Meaning : std::uint8_t { reflectance, light, number };
Texture read_texture_of(MitsubaReader& reader, const pugi::xml_node& node, std::string_view name, double otherwise,
                        Meaning meaning);
double read_index(MitsubaReader& reader, const pugi::xml_node& node, std::string_view name, const char* otherwise);
Texture read_metal_of(MitsubaReader& reader, const pugi::xml_node& node);

// mitsuba_bsdf.cpp
Material read_bsdf(MitsubaReader& reader, const pugi::xml_node& node);

// mitsuba_media.cpp
bool is_of_voxels(const MitsubaReader& reader, const pugi::xml_node& medium);
// Such a medium within a shape that is a boundary and nothing else.
void fill_boundary(MitsubaReader& reader, const pugi::xml_node& medium, const Mesh& mesh, const glm::dmat4& matrix);

// mitsuba_shapes.cpp
void read_shape_of(MitsubaReader& reader, const pugi::xml_node& node);

// mitsuba_emitters.cpp
void read_emitter(MitsubaReader& reader, const pugi::xml_node& node);
void read_sensor(MitsubaReader& reader, const pugi::xml_node& node);

} // namespace wavepath::convert
