// What is known while a pbrt file is read, and what its directives share.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/convert/described.h"
#include "host/convert/pbrt_params.h"
#include "host/convert/pbrt_tokens.h"
#include "host/convert/spectrum.h"

namespace wavepath::convert {

struct PbrtMedium {
  glm::dvec3 absorption{0.0}, scattering{0.0};
  double anisotropy = 0.0;
  std::optional<Volume> voxels; // that it is made of; without its file until a shape holds it, if `path` names that
  std::string path;
};

struct PbrtAttributes {
  glm::dmat4 transform{1.0};
  bool is_reversed = false, at_start = true, at_end = true; // transforms of the shutter's opening and close
  std::uint32_t material = 0;
  std::optional<PbrtParams> area_light;
  std::string inside;                         // medium
  std::map<std::string, PbrtParams> defaults; // of the directive Attribute, by what they are for
};

struct PbrtReader {
  explicit PbrtReader(const std::string& path) : tokens(path) {}

  PbrtTokens tokens;
  Description scene;
  PbrtAttributes now;
  std::vector<PbrtAttributes> saved;
  std::map<std::string, glm::dmat4> coordinate_systems;
  std::map<std::string, Texture> colors, numbers; // textures by name
  std::map<std::string, std::uint32_t> materials, groups;
  std::map<std::string, PbrtMedium> media;
  std::string volume;                 // the medium of `scene`.volume
  std::optional<std::uint32_t> group; // that shapes go into
  bool in_world = false;
  // Meshes and materials by what they were made of.
  std::map<std::pair<std::string, bool>, std::uint32_t> meshes;
  std::map<std::string, std::uint32_t> variants;
};

// pbrt_values.cpp: parameters as values.
Texture read_color(PbrtReader& reader, const PbrtParams& params, const char* name, const Texture& otherwise);
Texture read_scalar(PbrtReader& reader, const PbrtParams& params, const char* name, double otherwise);
// A spectrum of light, with a luminance of 1 unless it is RGB.
glm::dvec3 read_light_color(PbrtReader& reader, const PbrtParam* param);
// An unbounded spectrum, such as that of a coefficient of absorption, by its RGB.
glm::dvec3 read_coefficient(PbrtReader& reader, const PbrtParams& params, const char* name,
                            const glm::dvec3& otherwise);
double read_ior(PbrtReader& reader, const PbrtParams& params, const char* name, double otherwise);
// Reflectance at normal incidence of eta and k, whose names begin with `prefix`.
Texture read_metal(PbrtReader& reader, const PbrtParams& params, const std::string& prefix);
void read_texture(PbrtReader& reader, const std::string& name, const std::string& type, const std::string& kind,
                  const PbrtParams& params);
void tell_unused(PbrtReader& reader, const std::string& what, const PbrtParams& params);

// pbrt_materials.cpp
Material read_material(PbrtReader& reader, const std::string& type, const PbrtParams& params);

// pbrt_media.cpp
void read_medium(PbrtReader& reader, const std::string& name, const PbrtParams& params);
// The medium within a shape that is a boundary and nothing else.
void fill_boundary(PbrtReader& reader, const std::string& medium, const Mesh& mesh, const glm::dmat4& matrix);

// pbrt_lights.cpp
void read_light(PbrtReader& reader, const std::string& type, const PbrtParams& params);
// Radiance of an area light of this area, and whether it shines from both sides.
struct PbrtEmission {
  Texture radiance;
  bool both_sides = false;
};
PbrtEmission read_area_light(PbrtReader& reader, const PbrtParams& params, double area);

// pbrt_shapes.cpp
void read_shape(PbrtReader& reader, const std::string& type, const PbrtParams& params);

// pbrt_camera.cpp
void read_camera(PbrtReader& reader, const std::string& type, const PbrtParams& params);
void read_film(PbrtReader& reader, const PbrtParams& params);
// When all options are known.
void finish_camera(PbrtReader& reader);

} // namespace wavepath::convert
