// NanoVDB files that tests write.
#pragma once

#include <cstdint>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#define NANOVDB_USE_ZIP
#define NANOVDB_USE_BLOSC
#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/IO.h>

namespace wavepath::test {

using nanovdb::Coord;
using nanovdb::CoordBBox;
using GridHandle = nanovdb::GridHandle<>;

struct GridSpec {
  std::string name = "density";
  double voxel = 1.0; // side of a voxel
  nanovdb::Vec3d origin{0.0};
  float background = 0.0f;
  nanovdb::GridClass kind = nanovdb::GridClass::FogVolume;
};

// A grid with these values within the box, and its background elsewhere.
template <class Build = float, class Value = float, class Field>
GridHandle build_grid(const Field& field, const CoordBBox& box, const GridSpec& spec = {}) {
  nanovdb::GridBuilder<Value, Build> builder(static_cast<Value>(spec.background), spec.kind);
  builder([&](const Coord& p) { return static_cast<Value>(field(p)); }, box);
  return builder.getHandle(spec.voxel, spec.origin, spec.name);
}

// The file that io::writeGrid() makes, which wants a stream that can be written beyond its end.
inline std::vector<std::uint8_t> file_bytes(const GridHandle& handle, nanovdb::io::Codec codec) {
  std::stringstream stream(std::string(handle.size() + 4096, '\0'));
  nanovdb::io::writeGrid(static_cast<std::ostream&>(stream), handle, codec);
  const auto end = static_cast<std::size_t>(stream.tellp());
  const std::string text = stream.str();
  return {text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end)};
}

template <class... Handles>
void write_grids(const std::string& path, nanovdb::io::Codec codec, Handles&&... handles) {
  std::vector<GridHandle> list;
  (list.push_back(std::forward<Handles>(handles)), ...);
  nanovdb::io::writeGrids(path, list, codec);
}

} // namespace wavepath::test
