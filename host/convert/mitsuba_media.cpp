// Media of Mitsuba 3 that are made of voxels: a heterogeneous medium whose extinction is a grid.
#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/base/error.h"
#include "host/base/read_file.h"
#include "host/convert/grid_files.h"
#include "host/convert/mitsuba_reader.h"
#include "host/convert/textures.h"
#include "host/convert/volumes.h"

namespace wavepath::convert {
namespace {

constexpr double kMostGridVoxels = 134'217'728.0; // as read_nanovdb() takes them

// "VOL", version 3, then in little endian: type (1: floats), counts along x, y and z, channels, a box of six floats,
// values with x fastest.
struct GridHeader {
  char magic[3];
  std::uint8_t version;
  std::int32_t type, counts[3], channels;
  float box[6];
};

DenseGrid read_grid_file(const std::string& path) {
  const auto bytes = read_whole_file(path);
  if (!bytes) throw Error(path, "cannot be read", "put it where the scene names it");
  GridHeader header;
  const auto refuse = [&](const std::string& problem) {
    throw Error(path, problem, "write it anew by mitsuba.VolumeGrid.write()");
  };
  if (bytes->size() < sizeof(header)) refuse("is no grid of Mitsuba");
  std::memcpy(&header, bytes->data(), sizeof(header));
  if (std::memcmp(header.magic, "VOL", 3) != 0 || header.version != 3 || header.type != 1)
    refuse("is no grid of Mitsuba, of version 3 with floats");
  if (header.channels != 1) refuse(fmt::format("has {} numbers a voxel instead of one", header.channels));
  double voxels = 1.0;
  for (const std::int32_t count : header.counts) voxels *= std::max(count, 0);
  if (!(voxels >= 1.0 && voxels <= kMostGridVoxels) ||
      static_cast<double>(bytes->size() - sizeof(header)) < voxels * sizeof(float))
    refuse("has fewer voxels than it says");
  DenseGrid grid{"density", {header.counts[0], header.counts[1], header.counts[2]}};
  grid.values.resize(static_cast<std::size_t>(voxels));
  std::memcpy(grid.values.data(), bytes->data() + sizeof(header), grid.values.size() * sizeof(float));
  // Voxels are the middles of equal parts of the unit cube.
  const glm::dvec3 step = 1.0 / glm::dvec3(grid.counts);
  grid.grid_from_index = glm::scale(glm::translate(glm::dmat4(1.0), 0.5 * step), step);
  return grid;
}

} // namespace

bool is_of_voxels(const MitsubaReader& reader, const pugi::xml_node& medium) {
  if (!medium || attribute(reader, medium, "type") != "heterogeneous") return false;
  const pugi::xml_node extinction = named_child(reader, medium, "sigma_t");
  return extinction && attribute(reader, extinction, "type") == "gridvolume";
}

void fill_boundary(MitsubaReader& reader, const pugi::xml_node& medium, const Mesh& mesh, const glm::dmat4& matrix) {
  const pugi::xml_node extinction = named_child(reader, medium, "sigma_t");
  const std::string path = read_path(reader, extinction, read_text(reader, extinction, "filename", ""));
  if (read_bool(reader, extinction, "use_grid_bbox", false))
    reader.scene.losses.add("box of a grid of voxels: the unit cube instead");
  Volume volume;
  volume.file = nanovdb_file({read_grid_file(path)});
  volume.matrix = read_transform(reader, extinction);
  const glm::dvec3 albedo = mean(reader.scene, read_texture_of(reader, medium, "albedo", 0.75, Meaning::reflectance));
  const double scale = read_float(reader, medium, "scale", 1.0);
  volume.scattering = scale * glm::clamp(albedo, 0.0, 1.0);
  volume.absorption = glm::dvec3(scale) - volume.scattering;
  if (const pugi::xml_node phase = medium.child("phase"); phase && attribute(reader, phase, "type") == "hg")
    volume.anisotropy = std::clamp(read_float(reader, phase, "g", 0.8), -0.99, 0.99);
  set_volume(reader.scene, std::move(volume), path, mesh, matrix);
}

} // namespace wavepath::convert
