#include "host/scene/nanovdb/nanovdb.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/read_file.h"
#include "host/scene/nanovdb/bricks.h"
#include "host/scene/nanovdb/container.h"
#include "host/scene/nanovdb/tree.h"

namespace wavepath {
namespace {

using nvdb::ListedGrid;

constexpr std::size_t kMostNamed = 20; // grids in a message

bool is_named(const ListedGrid& grid, std::string_view lower_case) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::ranges::equal(grid.name, lower_case, {}, lower);
}

const ListedGrid* find_named(const std::vector<ListedGrid>& grids, std::string_view name) {
  const auto found = std::ranges::find_if(grids, [&](const ListedGrid& grid) { return is_named(grid, name); });
  return found == grids.end() ? nullptr : &*found;
}

bool can_be_density(const ListedGrid& grid) {
  return nvdb::holds_scalars(static_cast<std::uint32_t>(grid.type)) && grid.kind != nanovdb::GridClass::LevelSet &&
         !is_named(grid, "temperature");
}

std::string list_names(const std::vector<ListedGrid>& grids) {
  std::vector<std::string> names;
  for (const ListedGrid& grid : grids) {
    const std::string type = nvdb::type_name(static_cast<std::uint32_t>(grid.type));
    if (names.size() < kMostNamed) names.push_back(fmt::format("'{}' of type {}", grid.name, type));
  }
  return fmt::format("{}{}", fmt::join(names, ", "), grids.size() > names.size() ? ", ..." : "");
}

const ListedGrid& choose_density(const std::string& file, const std::vector<ListedGrid>& grids) {
  if (const ListedGrid* named = find_named(grids, "density")) return *named;
  const auto usable = std::ranges::count_if(grids, can_be_density);
  if (usable == 1) return *std::ranges::find_if(grids, can_be_density);
  if (grids.empty()) throw Error(file, "has no grids", "give a file with a grid 'density'");
  throw Error(file, "has no grid 'density' among " + list_names(grids),
              usable > 1 ? "give the one that is meant this name" : "give a file with a grid of scalars of this name");
}

VoxelGrid read_grid(const std::string& file, const ListedGrid& listed, bool is_density, Warnings& warnings) {
  const std::string what = fmt::format("its grid '{}'", listed.name);
  if (listed.kind == nanovdb::GridClass::LevelSet)
    throw Error(file, what + " is a level set: distances to a surface",
                "convert it to a fog volume (vdb_tool -ls2fog)");
  const auto type = static_cast<std::uint32_t>(listed.type);
  if (!nvdb::holds_scalars(type))
    throw Error(file, what + " holds values of type " + nvdb::type_name(type),
                "give it one number a voxel: float, double, Fp4, Fp8, Fp16 or FpN");
  std::vector<std::uint8_t> buffer;
  const nvdb::Tree tree = nvdb::read_tree(file, what, nvdb::grid_bytes(file, listed, buffer));
  const std::string short_name = fmt::format("grid '{}'", listed.name);
  if (tree.background != 0.0f) {
    if (is_density)
      throw Error(file, fmt::format("{} has background {}, which fills all of space", what, tree.background),
                  "give it background 0");
    warnings.add(fmt::format("background {} of {} taken as 0 outside of its box", tree.background, short_name));
  }
  VoxelGrid grid = nvdb::make_grid(file, what, tree, is_density, warnings);
  grid.name = listed.name;
  return grid;
}

} // namespace

VolumeGrids read_nanovdb(const std::string& file, std::span<const std::uint8_t> bytes, Warnings& warnings) {
  const std::vector<ListedGrid> grids = nvdb::list_grids(file, bytes);
  VolumeGrids volume;
  volume.path = file;
  volume.density = read_grid(file, choose_density(file, grids), true, warnings);
  if (volume.density.bricks.empty())
    throw Error(file, fmt::format("its grid '{}' has no density above 0", volume.density.name),
                "leave it out, or choose another file");
  if (const ListedGrid* temperature = find_named(grids, "temperature"))
    volume.temperature = read_grid(file, *temperature, false, warnings);
  return volume;
}

VolumeGrids read_nanovdb(const std::filesystem::path& path, Warnings& warnings) {
  const auto bytes = read_whole_file(path);
  if (!bytes) throw Error(path.string(), "cannot be read", "check that it exists and is a NanoVDB file (.nvdb)");
  return read_nanovdb(path.string(), *bytes, warnings);
}

} // namespace wavepath
