// Media of pbrt-v4. Those of voxels become the volume of the scene.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/base/error.h"
#include "host/base/read_file.h"
#include "host/convert/grid_files.h"
#include "host/convert/pbrt_reader.h"
#include "host/convert/volumes.h"

namespace wavepath::convert {
namespace {

constexpr double kMostVoxelsOfGrid = 134'217'728.0; // as read_nanovdb() takes them

void read_coefficients(PbrtReader& reader, const PbrtParams& params, PbrtMedium& medium) {
  const double scale = params.number("scale", 1.0);
  medium.absorption = scale * read_coefficient(reader, params, "sigma_a", glm::dvec3(1.0));
  medium.scattering = scale * read_coefficient(reader, params, "sigma_s", glm::dvec3(1.0));
  medium.anisotropy = params.number("g", 0.0);
}

// The volume of a medium, without its voxels.
Volume begin_volume(PbrtReader& reader, const PbrtParams& params, const PbrtMedium& medium) {
  Volume volume;
  volume.absorption = medium.absorption, volume.scattering = medium.scattering;
  volume.anisotropy = std::clamp(medium.anisotropy, -0.99, 0.99);
  if (volume.anisotropy != medium.anisotropy) reader.scene.losses.add("anisotropy of a medium: 0.99 instead");
  volume.emission = params.number("Lescale", 1.0);
  volume.temperature_scale = params.number("temperaturescale", 1.0);
  volume.temperature_offset = params.number("temperatureoffset", params.number("temperaturecutoff", 0.0));
  volume.matrix = reader.now.transform;
  return volume;
}

// Values of a grid, one for each voxel.
std::vector<float> values_of(PbrtReader& reader, const PbrtParam& param, const glm::ivec3& counts) {
  const double count = static_cast<double>(counts.x) * counts.y * counts.z;
  if (static_cast<double>(param.numbers.size()) != count)
    reader.tokens.fail(fmt::format("\"{}\" has {} numbers, where {} x {} x {} voxels have one each", param.name,
                                   param.numbers.size(), counts.x, counts.y, counts.z));
  std::vector<float> values;
  for (const double value : param.numbers) values.push_back(static_cast<float>(value));
  return values;
}

glm::dvec3 corner(const PbrtParams& params, const char* name, double otherwise) {
  const PbrtParam* param = params.find(name);
  if (!param || param->numbers.size() < 3) return glm::dvec3(otherwise);
  return {param->numbers[0], param->numbers[1], param->numbers[2]};
}

// The place of a grid of a medium: voxels are points in the middle of equal parts of a box.
struct GridPlace {
  glm::ivec3 counts{0};
  glm::dmat4 matrix{1.0}; // from index space

  std::size_t voxels() const {
    return static_cast<std::size_t>(counts.x) * static_cast<std::size_t>(counts.y) * static_cast<std::size_t>(counts.z);
  }
};

GridPlace read_place(PbrtReader& reader, const PbrtParams& params) {
  GridPlace place;
  glm::ivec3& counts = place.counts;
  const char* const names[] = {"nx", "ny", "nz"};
  double all = 1.0;
  for (int i = 0; i < 3; ++i) {
    const double count = params.number(names[i], 1.0);
    all *= count;
    if (!(count >= 1.0 && all <= kMostVoxelsOfGrid) || count != std::floor(count))
      reader.tokens.fail(fmt::format("a grid has {} {}", names[i], count));
    counts[i] = static_cast<int>(count);
  }
  const glm::dvec3 lo = corner(params, "p0", 0.0), hi = corner(params, "p1", 1.0);
  const glm::dvec3 step = (hi - lo) / glm::dvec3(counts);
  if (!(step.x * step.y * step.z != 0.0)) reader.tokens.fail("a grid has a box without a volume");
  place.matrix = glm::scale(glm::translate(glm::dmat4(1.0), lo + 0.5 * step), step);
  return place;
}

void read_uniform_grid(PbrtReader& reader, const PbrtParams& params, Volume& volume) {
  const auto [counts, matrix] = read_place(reader, params);
  std::vector<DenseGrid> grids;
  const PbrtParam* density = params.find("density");
  if (!density) reader.tokens.fail("a grid has no \"density\"");
  grids.push_back({"density", counts, values_of(reader, *density, counts), matrix});
  if (const PbrtParam* temperature = params.find("temperature"))
    grids.push_back({"temperature", counts, values_of(reader, *temperature, counts), matrix});
  if (params.has("Le")) reader.scene.losses.add("light of a medium by a spectrum");
  volume.file = nanovdb_file(grids);
}

// Three numbers for each voxel; 1 where the medium has none.
std::vector<glm::dvec3> colors_of(PbrtReader& reader, const PbrtParams& params, const char* name, std::size_t voxels) {
  const PbrtParam* param = params.find(name);
  std::vector<glm::dvec3> colors(voxels, glm::dvec3(1.0));
  if (!param) return colors;
  const std::vector<double>& numbers = param->numbers;
  if (numbers.size() != 3 * voxels)
    reader.tokens.fail(
        fmt::format("\"{}\" has {} numbers, where {} voxels have three each", name, numbers.size(), voxels));
  for (std::size_t i = 0; i < voxels; ++i) colors[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
  return colors;
}

// A grid of coefficients that have the same colours everywhere, as those of one density. False if they have not.
bool read_rgb_grid(PbrtReader& reader, const PbrtParams& params, Volume& volume) {
  constexpr double kSameColor = 1e-4;
  const GridPlace place = read_place(reader, params);
  const std::vector<glm::dvec3> absorption = colors_of(reader, params, "sigma_a", place.voxels()),
                                scattering = colors_of(reader, params, "sigma_s", place.voxels());
  const auto sum = [&](std::size_t i) {
    const glm::dvec3 both = absorption[i] + scattering[i];
    return both.x + both.y + both.z;
  };
  std::size_t densest = 0;
  for (std::size_t i = 0; i < place.voxels(); ++i)
    if (sum(i) > sum(densest)) densest = i;
  const double most = sum(densest);
  if (!(most > 0.0) || params.has("Le")) return false;
  DenseGrid grid{"density", place.counts, {}, place.matrix};
  for (std::size_t i = 0; i < place.voxels(); ++i) {
    const double density = sum(i) / most;
    for (const auto* colors : {&absorption, &scattering})
      if (glm::length((*colors)[i] - density * (*colors)[densest]) > kSameColor * most) return false;
    grid.values.push_back(static_cast<float>(density));
  }
  const double scale = params.number("scale", 1.0);
  volume.absorption = scale * absorption[densest], volume.scattering = scale * scattering[densest];
  volume.file = nanovdb_file({grid});
  return true;
}

// A medium whose kind of voxels no volume has; nothing else of it is told.
void lose_medium(PbrtReader& reader, const std::string& type, const PbrtParams& params) {
  reader.scene.losses.add(fmt::format("medium '{}'", type));
  for (const PbrtParam& param : params.all) param.is_used = true;
}

} // namespace

void read_medium(PbrtReader& reader, const std::string& name, const PbrtParams& params) {
  const std::string type = params.text("type", "homogeneous");
  PbrtMedium medium;
  if (type == "homogeneous" && params.has("preset")) {
    reader.scene.losses.add("medium by the name of a preset: clear instead");
    medium.anisotropy = params.number("g", 0.0);
    params.number("scale", 1.0);
  } else if (type == "homogeneous") {
    read_coefficients(reader, params, medium);
  } else if (type == "nanovdb" || type == "uniformgrid") {
    read_coefficients(reader, params, medium);
    medium.voxels = begin_volume(reader, params, medium);
    if (type == "nanovdb")
      medium.path = reader.tokens.resolved(params.text("filename", ""));
    else
      read_uniform_grid(reader, params, *medium.voxels);
    medium.absorption = medium.scattering = glm::dvec3(0.0); // of a body of glass: the voxels are in the air alone
  } else if (type == "rgbgrid") {
    medium.anisotropy = params.number("g", 0.0);
    Volume volume = begin_volume(reader, params, medium);
    if (read_rgb_grid(reader, params, volume))
      medium.voxels = std::move(volume);
    else
      lose_medium(reader, "rgbgrid of other colours here than there", params);
  } else {
    lose_medium(reader, type, params);
  }
  tell_unused(reader, fmt::format("medium '{}'", type), params);
  reader.media[name] = medium;
}

void fill_boundary(PbrtReader& reader, const std::string& name, const Mesh& mesh, const glm::dmat4& matrix) {
  const PbrtMedium& medium = reader.media.at(name);
  Description& scene = reader.scene;
  if (!medium.voxels) return scene.losses.add("medium in the air");
  if (reader.group) return scene.losses.add("medium of voxels in an object");
  if (scene.volume && reader.volume == name) return; // a boundary of several shapes
  Volume volume = *medium.voxels;
  if (!medium.path.empty()) {
    auto bytes = read_whole_file(medium.path);
    if (!bytes) throw Error(medium.path, "cannot be read", "put it where the scene names it");
    volume.file = std::move(*bytes);
  }
  if (!scene.volume) reader.volume = name;
  set_volume(scene, std::move(volume), medium.path.empty() ? name : medium.path, mesh, matrix);
}

} // namespace wavepath::convert
