#include "host/convert/grid_files.h"

#include <sstream>

#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/IO.h>

namespace wavepath::convert {
namespace {

nanovdb::GridHandle<> build(const DenseGrid& grid) {
  nanovdb::GridBuilder<float> builder(0.0f, nanovdb::GridClass::FogVolume);
  const glm::ivec3 n = grid.counts;
  const auto value = [&](const nanovdb::Coord& p) {
    return grid
        .values[(static_cast<std::size_t>(p[2]) * static_cast<std::size_t>(n.y) + static_cast<std::size_t>(p[1])) *
                    static_cast<std::size_t>(n.x) +
                static_cast<std::size_t>(p[0])];
  };
  builder(value, {nanovdb::Coord(0), nanovdb::Coord(n.x - 1, n.y - 1, n.z - 1)});
  nanovdb::Map map; // of matrices that stand behind a row, whose rows are our columns
  map.set(grid.grid_from_index, glm::inverse(grid.grid_from_index), 1.0);
  return builder.getHandle(map, grid.name);
}

} // namespace

std::vector<std::uint8_t> nanovdb_file(const std::vector<DenseGrid>& grids) {
  std::vector<nanovdb::GridHandle<>> handles;
  std::size_t size = 4096; // of the header, at most
  for (const DenseGrid& grid : grids) {
    handles.push_back(build(grid));
    size += handles.back().size();
  }
  std::stringstream stream(std::string(size, '\0')); // written beyond its beginning first
  nanovdb::io::writeGrids(static_cast<std::ostream&>(stream), handles);
  const auto end = static_cast<std::size_t>(stream.tellp());
  const std::string text = std::move(stream).str();
  return {text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end)};
}

} // namespace wavepath::convert
