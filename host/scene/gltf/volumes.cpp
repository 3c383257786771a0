#include "host/scene/gltf/volumes.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/scene/bounds.h"
#include "host/scene/gltf/property.h"
#include "host/scene/gltf/uri.h"
#include "host/scene/nanovdb/nanovdb.h"
#include "host/scene/staging/volume.h"

namespace wavepath::gltf {
namespace {

using nlohmann::json;

constexpr const char* kVolumeKeys[] = {"file",     "scattering",        "absorption",         "anisotropy",
                                       "emission", "temperature_scale", "temperature_offset", "density"};

// Reads the members of one object.
struct VolumeMembers {
  const Document& document;
  const json& object;
  std::string what; // "the volume of node 3"

  [[noreturn]] void refuse(const char* name, const std::string& problem) const {
    document.fail(fmt::format("{} has {} {}", what, name, problem));
  }

  double number(const char* name, double initial, double lowest, double highest) const {
    const auto found = object.find(name);
    return found == object.end() ? initial : checked(name, *found, lowest, highest);
  }

  // Three numbers, or one for all of them.
  glm::vec3 color(const char* name, float initial) const {
    const auto found = object.find(name);
    if (found == object.end()) return glm::vec3(initial);
    if (!found->is_array()) return glm::vec3(static_cast<float>(checked(name, *found, 0.0, kMostCoefficient)));
    if (found->size() != 3) refuse(name, fmt::format("of {} numbers instead of three", found->size()));
    glm::vec3 result;
    for (int i = 0; i < 3; ++i)
      result[i] = static_cast<float>(checked(name, (*found)[static_cast<std::size_t>(i)], 0.0, kMostCoefficient));
    return result;
  }

private:
  double checked(const char* name, const json& value, double lowest, double highest) const {
    if (!value.is_number()) refuse(name, "'" + shown(value.dump()) + "', which is no number");
    const double number = value;
    if (!(number >= lowest && number <= highest))
      refuse(name, fmt::format("{}, which is not within {:g} and {:g}", number, lowest, highest));
    return number;
  }
};

NodeVolume read_volume(Document& document, std::size_t node, const json& object) {
  const VolumeMembers members{document, object, fmt::format("the volume of node {}", node)};
  NodeVolume found;
  found.node = node;
  found.source.uri = object["file"];
  Volume& volume = found.volume;
  const auto density = static_cast<float>(members.number("density", 1.0, 0.0, kMostCoefficient));
  volume.scattering = density * members.color("scattering", 1.0f);
  volume.absorption = density * members.color("absorption", 0.0f);
  const auto number = [&](const char* name, double initial, double lowest, double highest) {
    return static_cast<float>(members.number(name, initial, lowest, highest));
  };
  volume.anisotropy = number("anisotropy", 0.0, -kMostAnisotropy, kMostAnisotropy);
  volume.emission = number("emission", 1.0, 0.0, kMostEmission);
  volume.temperature_scale = number("temperature_scale", 1.0, -kMostTemperature, kMostTemperature);
  volume.temperature_offset = number("temperature_offset", 0.0, -kMostTemperature, kMostTemperature);
  for (const auto& [key, value] : object.items())
    if (std::ranges::find(kVolumeKeys, key) == std::end(kVolumeKeys))
      document.warnings.add(
          fmt::format("'{}' of {} ignored: wavepath knows no such property", shown(key), members.what));
  return found;
}

bool is_invertible(const glm::dmat4& matrix) {
  const double determinant = glm::determinant(glm::dmat3(matrix));
  return std::isfinite(determinant) && std::isfinite(1.0 / determinant);
}

std::shared_ptr<const VolumeGrids> read_grids(Document& document, const NodeVolume& volume, Warnings& warnings) {
  const auto path = resolve_uri(document.path.parent_path(), volume.source.uri);
  if (!path)
    document.fail(fmt::format("the volume of node {} refers to '{}', which is outside the folder of the file",
                              volume.node, shown(volume.source.uri)),
                  "put the data beside the file and use a relative name");
  Warnings found;
  auto grids = std::make_shared<const VolumeGrids>(read_nanovdb(*path, found));
  for (Warnings* all : {&document.warnings, &warnings})
    for (const auto& [text, count] : found.counts()) all->add(text, count);
  return grids;
}

} // namespace

std::vector<NodeVolume> find_volumes(Document& document, const json& root) {
  std::vector<NodeVolume> volumes;
  const auto nodes = root.find("nodes");
  if (nodes == root.end()) return volumes;
  for (std::size_t i = 0; i < nodes->size(); ++i) {
    const json* object = find_property((*nodes)[i], "extras.volume");
    if (!object || !object->is_object()) continue; // another program's
    const auto file = object->find("file");
    if (file == object->end() || !file->is_string())
      document.warnings.add("'volume' among the extras of a node ignored: it names no file");
    else
      volumes.push_back(read_volume(document, i, *object));
  }
  return volumes;
}

std::optional<Volume> place_volume(Document& document, Warnings& warnings, const std::vector<int>& nodes,
                                   const std::vector<bool>& hidden, const std::vector<glm::dmat4>& world,
                                   bool is_replaced) {
  NodeVolume* shown_volume = nullptr;
  for (NodeVolume& volume : document.volumes) {
    if (hidden[volume.node] || std::ranges::find(nodes, static_cast<int>(volume.node)) == nodes.end()) continue;
    if (shown_volume && !is_replaced)
      document.fail(fmt::format("shows two volumes, of nodes {} and {}", shown_volume->node, volume.node),
                    "hide one of them (KHR_node_visibility), or make one NanoVDB file of both");
    shown_volume = &volume;
  }
  if (!shown_volume) return {};
  if (is_replaced) {
    warnings.add(fmt::format("volume '{}' of the file replaced by --volume", shown(shown_volume->source.uri)));
    return {};
  }
  if (!shown_volume->volume.grids) shown_volume->volume.grids = read_grids(document, *shown_volume, warnings);
  Volume volume = shown_volume->volume;
  volume.world_from_grid = world[shown_volume->node];
  const Bounds box = volume_bounds(volume);
  if (is_invertible(volume.world_from_grid) && finite_point(box.lo) && finite_point(box.hi)) return volume;
  warnings.add("volume with a transform that cannot be inverted, or beyond the largest coordinates, left out");
  return {};
}

} // namespace wavepath::gltf
