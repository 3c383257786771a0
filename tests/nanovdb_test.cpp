// NanoVDB files: values as NanoVDB's accessor has them, what is refused, and damage.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/base/read_file.h"
#include "host/scene/material.h"
#include "host/scene/nanovdb/nanovdb.h"
#include "tests/temporary_folder.h"
#include "tests/volume_files.h"

namespace wavepath {
namespace {

using nanovdb::io::Codec;
using test::build_grid;
using test::Coord;
using test::CoordBBox;
using test::GridHandle;
using test::GridSpec;
using test::write_grids;

float value_at(const VoxelGrid& grid, const Coord& p) {
  const glm::ivec3 place = glm::ivec3(p[0], p[1], p[2]) - grid.first;
  if (glm::any(glm::lessThan(place, glm::ivec3(0)))) return 0.0f;
  const glm::ivec3 brick = place / kBrickSide, in = place % kBrickSide;
  if (glm::any(glm::greaterThanEqual(brick, grid.brick_counts))) return 0.0f;
  const auto index =
      static_cast<std::size_t>((brick.z * grid.brick_counts.y + brick.y) * grid.brick_counts.x + brick.x);
  if (grid.bricks[index] == kNoIndex) return grid.constants[index];
  return grid.voxels[grid.bricks[index] * kBrickVoxels + static_cast<std::size_t>(in.x * 64 + in.y * 8 + in.z)];
}

// A ball with noise, which no brick has constant.
float noisy_ball(const Coord& p) {
  const double distance = std::hypot(p[0] - 3, p[1] + 2, p[2] - 5);
  const double noise = 0.5 + 0.5 * std::sin(12.9898 * p[0] + 78.233 * p[1] + 37.719 * p[2]);
  return distance < 20.0 ? static_cast<float>((20.0 - distance) * 0.05 + 0.2 * noise) : 0.0f;
}

const CoordBBox kBallBox(Coord(-30), Coord(40));

std::string refusal(const std::string& path) {
  Warnings warnings;
  try {
    read_nanovdb(std::filesystem::path(path), warnings);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::size_t warning_count(const Warnings& warnings, const std::string& part) {
  std::size_t sum = 0;
  for (const auto& [text, count] : warnings.counts())
    if (text.find(part) != std::string::npos) sum += count;
  return sum;
}

class NanovdbFile : public testing::Test {
protected:
  // The grids of a file with these.
  template <class... Handles>
  VolumeGrids read(Codec codec, Handles&&... handles) {
    write_grids(path, codec, std::forward<Handles>(handles)...);
    warnings = {};
    return read_nanovdb(std::filesystem::path(path), warnings);
  }
  template <class... Handles>
  std::string refused(Handles&&... handles) {
    write_grids(path, Codec::NONE, std::forward<Handles>(handles)...);
    return refusal(path);
  }

  test::TemporaryFolder folder;
  std::string path = folder.file("cloud.nvdb");
  Warnings warnings;
};

template <class Build>
void expect_values_of_accessor(const VoxelGrid& grid, const GridHandle& handle, const CoordBBox& box) {
  const auto accessor = handle.grid<Build>()->getAccessor();
  std::size_t wrong = 0, nonzero = 0;
  for (int x = box.min()[0]; x <= box.max()[0]; ++x)
    for (int y = box.min()[1]; y <= box.max()[1]; ++y)
      for (int z = box.min()[2]; z <= box.max()[2]; ++z) {
        const auto expected = static_cast<float>(accessor.getValue(Coord(x, y, z)));
        nonzero += expected != 0.0f;
        wrong += value_at(grid, Coord(x, y, z)) != expected;
      }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(nonzero, 1000u);
}

template <class Build, class Value = float>
void check_type(const std::string& path) {
  for (const Codec codec : {Codec::NONE, Codec::ZIP, Codec::BLOSC}) {
    write_grids(path, codec, build_grid<Build, Value>(noisy_ball, kBallBox));
    const GridHandle handle = build_grid<Build, Value>(noisy_ball, kBallBox);
    Warnings warnings;
    const VolumeGrids grids = read_nanovdb(std::filesystem::path(path), warnings);
    EXPECT_TRUE(warnings.empty());
    EXPECT_FALSE(grids.density.voxels.empty());
    expect_values_of_accessor<Build>(grids.density, handle, CoordBBox(Coord(-40), Coord(48)));
  }
}

TEST_F(NanovdbFile, ValuesOfFloat) { check_type<float>(path); }
TEST_F(NanovdbFile, ValuesOfDouble) { check_type<double, double>(path); }
TEST_F(NanovdbFile, ValuesOfFp4) { check_type<nanovdb::Fp4>(path); }
TEST_F(NanovdbFile, ValuesOfFp8) { check_type<nanovdb::Fp8>(path); }
TEST_F(NanovdbFile, ValuesOfFp16) { check_type<nanovdb::Fp16>(path); }
TEST_F(NanovdbFile, ValuesOfFpN) { check_type<nanovdb::FpN>(path); }

TEST_F(NanovdbFile, ValuesOfEveryWidthOfFpN) {
  // Values of one, two, four, eight and sixteen bits, by brick.
  const auto steps = [](const Coord& p) {
    const int bits = 1 << ((p[0] >> 3) & 3), levels = (1 << std::min(bits, 12)) - 1;
    return static_cast<float>(1 + (p[1] * 64 + p[2] * 8 + p[0] * 77) % (levels + 1)) / static_cast<float>(levels + 1);
  };
  const CoordBBox box(Coord(0), Coord(63));
  const VolumeGrids grids = read(Codec::NONE, build_grid<nanovdb::FpN>(steps, box));
  expect_values_of_accessor<nanovdb::FpN>(grids.density, build_grid<nanovdb::FpN>(steps, box), box);
}

TEST_F(NanovdbFile, TilesBecomeConstantBricks) {
  // Leaves, tiles of 8 and a tile of 128 voxels a side, on both sides of the origin.
  const auto field = [](const Coord& p) { return p[0] >= 128 ? 0.25f : p[1] > 3 ? 0.5f : 0.0f; };
  const CoordBBox box(Coord(-16, -16, 0), Coord(255, 127, 127));
  const VolumeGrids grids = read(Codec::NONE, build_grid(field, box));
  const GridHandle handle = build_grid(field, box);
  EXPECT_EQ(handle.grid<float>()->tree().nodeCount(1), 3u); // the lower node at 128,0,0 became a tile
  expect_values_of_accessor<float>(grids.density, handle, CoordBBox(Coord(-20, -20, -4), Coord(260, 130, 130)));
  EXPECT_LT(grids.density.voxels.size(), 18 * 16 * kBrickVoxels + 1); // the layer around y = 3 alone
}

TEST_F(NanovdbFile, BoxHasNoBorderOfZeros) {
  const VolumeGrids grids = read(Codec::NONE, build_grid(
                                                  [](const Coord& p) {
                                                    const bool inside =
                                                        p[0] >= -8 && p[0] < 24 && p[1] == 9 && p[2] > 70;
                                                    return inside ? 0.1f * static_cast<float>(p[2]) : 0.0f;
                                                  },
                                                  CoordBBox(Coord(-64), Coord(80))));
  EXPECT_EQ(grids.density.first, glm::ivec3(-8, 8, 64));
  EXPECT_EQ(grids.density.brick_counts, glm::ivec3(4, 1, 3));
}

TEST_F(NanovdbFile, MapLeadsFromVoxelsToSpace) {
  GridSpec spec;
  spec.voxel = 0.125, spec.origin = {1.0, -2.0, 3.5};
  const VolumeGrids grids = read(Codec::NONE, build_grid(noisy_ball, kBallBox, spec));
  const GridHandle handle = build_grid(noisy_ball, kBallBox, spec);
  const nanovdb::Vec3d expected = handle.grid<float>()->indexToWorld(nanovdb::Vec3d(3, -7, 11));
  const glm::dvec4 point = grids.density.grid_from_index * glm::dvec4(3, -7, 11, 1);
  for (int i = 0; i < 3; ++i) EXPECT_DOUBLE_EQ(point[i], expected[i]);
}

TEST_F(NanovdbFile, MatrixWithShear) {
  GridHandle handle = build_grid(noisy_ball, kBallBox);
  auto* data = reinterpret_cast<nanovdb::GridData*>(handle.data());
  const double rows[9] = {0.5, 0.25, 0, 0, 2, -1, 0.125, 0, 3};
  std::copy(rows, rows + 9, data->mMap.mMatD);
  const nanovdb::Vec3d expected = handle.grid<float>()->indexToWorld(nanovdb::Vec3d(3, -7, 11));
  const VolumeGrids grids = read(Codec::NONE, std::move(handle));
  const glm::dvec4 point = grids.density.grid_from_index * glm::dvec4(3, -7, 11, 1);
  for (int i = 0; i < 3; ++i) EXPECT_DOUBLE_EQ(point[i], expected[i]);
}

TEST_F(NanovdbFile, TemperatureBesideDensity) {
  GridSpec density, temperature;
  density.name = "Density", temperature.name = "TEMPERATURE";
  const auto warmth = [](const Coord& p) { return 300.0f + static_cast<float>(p[0]); };
  const VolumeGrids grids = read(Codec::ZIP, build_grid(warmth, CoordBBox(Coord(0), Coord(20)), temperature),
                                 build_grid(noisy_ball, kBallBox, density));
  EXPECT_EQ(grids.density.name, "Density");
  ASSERT_TRUE(grids.temperature);
  EXPECT_EQ(value_at(*grids.temperature, Coord(7, 3, 4)), 307.0f);
  EXPECT_EQ(value_at(grids.density, Coord(7, 3, 4)), noisy_ball(Coord(7, 3, 4)));
}

TEST_F(NanovdbFile, ColdGridKeepsNumbersBelowZero) {
  GridSpec spec;
  spec.name = "temperature", spec.background = -5.0f;
  const auto cold = [](const Coord& p) { return static_cast<float>(p[0] - 10); };
  const VolumeGrids grids =
      read(Codec::NONE, build_grid(cold, CoordBBox(Coord(0), Coord(20)), spec), build_grid(noisy_ball, kBallBox));
  ASSERT_TRUE(grids.temperature);
  EXPECT_EQ(value_at(*grids.temperature, Coord(2, 0, 0)), -8.0f);
  EXPECT_EQ(value_at(*grids.temperature, Coord(22, 0, 0)), -5.0f);
  EXPECT_EQ(warning_count(warnings, "background -5 of grid 'temperature'"), 1u);
}

TEST_F(NanovdbFile, OneGridOfAnyNameIsTheDensity) {
  GridSpec smoke, temperature;
  smoke.name = "smoke", temperature.name = "temperature";
  EXPECT_EQ(read(Codec::NONE, build_grid(noisy_ball, kBallBox, temperature), build_grid(noisy_ball, kBallBox, smoke))
                .density.name,
            "smoke");
  GridSpec other;
  other.name = "fuel";
  const std::string message = refused(build_grid(noisy_ball, kBallBox, other), build_grid(noisy_ball, kBallBox, smoke));
  EXPECT_NE(message.find("no grid 'density' among 'fuel' of type float, 'smoke' of type float"), std::string::npos)
      << message;
}

TEST_F(NanovdbFile, OtherGridsAreRefusedByName) {
  nanovdb::GridBuilder<nanovdb::Vec3f> builder;
  builder([](const Coord& p) { return nanovdb::Vec3f(static_cast<float>(p[0]), 1.0f, 0.0f); },
          CoordBBox(Coord(0), Coord(9)));
  std::string message = refused(builder.getHandle(1.0, nanovdb::Vec3d(0.0), "density"));
  EXPECT_NE(message.find("its grid 'density' holds values of type Vec3f"), std::string::npos) << message;
  GridSpec surface;
  surface.kind = nanovdb::GridClass::LevelSet, surface.background = 3.0f;
  message = refused(build_grid(noisy_ball, kBallBox, surface));
  EXPECT_NE(message.find("is a level set"), std::string::npos) << message;
  GridSpec fog;
  fog.background = 2.0f;
  message = refused(build_grid(noisy_ball, kBallBox, fog));
  EXPECT_NE(message.find("has background 2"), std::string::npos) << message;
  message = refused(build_grid([](const Coord&) { return 0.0f; }, kBallBox));
  EXPECT_NE(message.find("has no density above 0"), std::string::npos) << message;
}

TEST_F(NanovdbFile, ValuesThatNoDensityHasBecomeZero) {
  const auto field = [](const Coord& p) {
    if (p == Coord(1, 1, 1)) return std::numeric_limits<float>::quiet_NaN();
    if (p == Coord(2, 1, 1)) return std::numeric_limits<float>::infinity();
    return p[0] == 4 ? -1.0f : 1.0f + static_cast<float>(p[2]);
  };
  const VolumeGrids grids = read(Codec::NONE, build_grid(field, CoordBBox(Coord(0), Coord(7))));
  EXPECT_EQ(warning_count(warnings, "'density' below 0"), 64u);
  EXPECT_EQ(warning_count(warnings, "'density' that are not finite"), 2u);
  EXPECT_EQ(value_at(grids.density, Coord(1, 1, 1)), 0.0f);
  EXPECT_EQ(value_at(grids.density, Coord(4, 1, 1)), 0.0f);
  EXPECT_EQ(value_at(grids.density, Coord(5, 1, 1)), 2.0f);
}

TEST_F(NanovdbFile, LargeBoxIsRefused) {
  nanovdb::GridBuilder<float> builder;
  auto accessor = builder.getAccessor();
  for (int i = 0; i < 2; ++i) accessor.setValue(Coord(i * 4000), 1.0f);
  const std::string message = refused(builder.getHandle(1.0, nanovdb::Vec3d(0.0), "density"));
  EXPECT_NE(message.find("spans 4008 x 4008 x 4008 voxels"), std::string::npos) << message;
  EXPECT_NE(message.find("resample it"), std::string::npos) << message;
}

TEST_F(NanovdbFile, OtherFilesAreRefused) {
  const auto write = [&](const std::string& text) { std::ofstream(path, std::ios::binary) << text; };
  EXPECT_NE(refusal(folder.file("missing.nvdb")).find("cannot be read"), std::string::npos);
  for (const char* text : {"", "{}", "no volume, but a line of text"}) {
    write(text);
    EXPECT_NE(refusal(path).find("is no NanoVDB file"), std::string::npos) << refusal(path);
  }
  write(std::string(" BDV\0\0\0\0", 8) + std::string(64, '\0'));
  EXPECT_NE(refusal(path).find("nanovdb_convert"), std::string::npos) << refusal(path);
}

// Reads damaged bytes; whatever comes must be an Error of one line, or grids.
void expect_harmless(const std::vector<std::uint8_t>& bytes) {
  Warnings warnings;
  try {
    read_nanovdb("cloud.nvdb", bytes, warnings);
  } catch (const Error& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("cloud.nvdb: ")) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

TEST_F(NanovdbFile, CutShort) {
  for (const Codec codec : {Codec::NONE, Codec::ZIP, Codec::BLOSC}) {
    write_grids(path, codec, build_grid(noisy_ball, CoordBBox(Coord(0), Coord(12))));
    const std::vector<std::uint8_t> whole = *read_whole_file(path);
    for (std::size_t i = 0; i < 100; ++i) {
      const std::size_t size = i < 50 ? i * 8 : whole.size() * (i - 50) / 50;
      expect_harmless({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
    }
  }
}

TEST_F(NanovdbFile, Damaged) {
  std::mt19937 random(7);
  for (const Codec codec : {Codec::NONE, Codec::ZIP, Codec::BLOSC}) {
    write_grids(path, codec, build_grid<nanovdb::FpN>(noisy_ball, CoordBBox(Coord(0), Coord(12))));
    const std::vector<std::uint8_t> whole = *read_whole_file(path);
    for (int round = 0; round < 100; ++round) {
      std::vector<std::uint8_t> bytes = whole;
      const std::size_t end = round % 2 ? bytes.size() : std::min<std::size_t>(bytes.size(), 1200);
      for (int i = 0; i < 8; ++i) bytes[random() % end] ^= static_cast<std::uint8_t>(1 << random() % 8);
      expect_harmless(bytes);
    }
  }
}

TEST_F(NanovdbFile, NodesThatShareChildrenAreRefused) {
  // Every entry of the upper node leads to its one lower node.
  GridHandle handle = build_grid(noisy_ball, CoordBBox(Coord(0), Coord(12)));
  using Upper = nanovdb::NanoUpper<float>::DataType;
  auto& tree = *reinterpret_cast<nanovdb::TreeData<3>*>(handle.data() + sizeof(nanovdb::GridData));
  auto& upper = *reinterpret_cast<Upper*>(reinterpret_cast<std::uint8_t*>(&tree) + tree.mNodeOffset[2]);
  for (std::uint32_t n = 0; n < 32768; ++n) {
    upper.mChildMask.setOn(n);
    upper.mTable[n].child = upper.mTable[0].child;
  }
  const std::string message = refused(std::move(handle));
  EXPECT_NE(message.find("has more nodes than fit into its data"), std::string::npos) << message;
}

} // namespace
} // namespace wavepath
