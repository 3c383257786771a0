#include "host/scene/staging/volume.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/base/error.h"
#include "host/base/shell_quote.h"
#include "host/scene/bounds.h"
#include "host/scene/nanovdb/nanovdb.h"

namespace wavepath {
namespace {

glm::dmat4 placed(const VolumeRequest& request, const VoxelGrid& density) {
  if (!request.at) return glm::dmat4(1.0);
  const Bounds box = index_bounds(density);
  const glm::dmat4& matrix = density.grid_from_index;
  double longest = 0.0;
  for (int i = 0; i < 3; ++i) longest = std::max(longest, (box.hi[i] - box.lo[i]) * glm::length(glm::dvec3(matrix[i])));
  const double scale = request.size > 0.0 ? request.size / longest : 1.0;
  const glm::dmat4 scaled = glm::scale(glm::translate(glm::dmat4(1.0), *request.at), glm::dvec3(scale));
  return glm::translate(scaled, -transform_point(matrix, box.centre()));
}

} // namespace

Volume load_volume(const VolumeRequest& request, Warnings& warnings) {
  Volume volume;
  volume.grids = std::make_shared<const VolumeGrids>(read_nanovdb(std::filesystem::path(request.file), warnings));
  volume.world_from_grid = placed(request, volume.grids->density);
  const Bounds box = volume_bounds(volume);
  if (!finite_point(box.lo) || !finite_point(box.hi))
    throw Error(request.file, "lies beyond the largest coordinates", "place it by --volume-at X,Y,Z,SIZE");
  volume.scattering = glm::vec3(request.density * request.albedo);
  volume.absorption = glm::vec3(request.density * (1.0 - request.albedo));
  volume.anisotropy = static_cast<float>(request.anisotropy);
  volume.emission = static_cast<float>(request.emission);
  volume.temperature_scale = static_cast<float>(request.temperature_scale);
  volume.temperature_offset = static_cast<float>(request.temperature_offset);
  return volume;
}

std::string flags_of(const VolumeRequest& request) {
  const VolumeRequest usual;
  std::string flags;
  if (!request.file.empty()) flags += " --volume " + shell_quoted(request.file);
  if (const auto& at = request.at) {
    flags += fmt::format(" --volume-at {},{},{}", at->x, at->y, at->z);
    if (request.size > 0.0) flags += fmt::format(",{}", request.size);
  }
  const auto add = [&](const char* flag, double value, double initial) {
    if (value != initial) flags += fmt::format(" {} {}", flag, value);
  };
  add("--volume-density", request.density, usual.density);
  if (const glm::dvec3& albedo = request.albedo; albedo != usual.albedo)
    flags += fmt::format(" --volume-albedo {},{},{}", albedo.r, albedo.g, albedo.b);
  add("--volume-anisotropy", request.anisotropy, usual.anisotropy);
  add("--volume-emission", request.emission, usual.emission);
  if (request.temperature_offset != usual.temperature_offset)
    flags += fmt::format(" --volume-temperature {},{}", request.temperature_scale, request.temperature_offset);
  else
    add("--volume-temperature", request.temperature_scale, usual.temperature_scale);
  return flags;
}

} // namespace wavepath
