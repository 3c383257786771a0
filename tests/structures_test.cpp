// The structures of `wavepath bench --structures`: that their kernels find what testing every triangle
// finds, to the last bit, and what the builders make of hard cases.
#include <array>
#include <bit>
#include <functional>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "bvh/binary.h"
#include "bvh/build.h"
#include "bvh/intersect.h"
#include "host/bench/structure_comparison.h"
#include "host/bench/structures/boxes.h"
#include "host/bench/structures/device_structure.h"
#include "tests/meshes.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

using bvh::Random;
using bvh::Triangles;
using bvh::Vec3;

Triangles soup(std::size_t count, float size, unsigned seed) {
  Random random(seed);
  Triangles triangles;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 corner = random.point(-1, 1);
    triangles.push_back({corner, corner + random.point(-1, 1) * size, corner + random.point(-1, 1) * size});
  }
  return triangles;
}

// Two triangles of a square in the plane z = 0.
Triangles square() { return {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}}, {{-1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}}; }

// Needles across everything, small ones, one that covers all, and one that has no area.
Triangles mixture() {
  Triangles triangles = soup(500, 0.05f, 2), large = soup(40, 3.0f, 3);
  triangles.insert(triangles.end(), large.begin(), large.end());
  for (int i = 0; i < 20; ++i) {
    const float x = 0.1f * static_cast<float>(i) - 1.0f;
    triangles.push_back({{x, -1, -1}, {x, 1, 1}, {x + 1e-4f, 1, 1}});
  }
  triangles.push_back({{-9, -9, 0.5f}, {9, -9, 0.5f}, {0, 9, 0.5f}});
  triangles.push_back({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}});
  return triangles;
}

std::vector<StructureRay> all_rays() {
  Random random(5);
  std::vector<StructureRay> rays;
  const auto add = [&](Vec3 origin, Vec3 direction, float t_max) {
    rays.push_back({{origin.x, origin.y, origin.z}, t_max, {direction.x, direction.y, direction.z}});
  };
  for (int i = 0; i < 1000; ++i) {
    add(random.point(-1, 1), random.direction(), gpu::kFar);
    const Vec3 outside = random.direction() * 5.0f;
    add(outside, (random.point(-1, 1) - outside) * 0.3f, i % 3 == 0 ? 4.0f : gpu::kFar);
  }
  for (int axis = 0; axis < 3; ++axis) // along axes, some in the planes between cells, in both directions
    for (int i = 0; i < 300; ++i) {
      Vec3 origin = i % 2 == 0 ? random.point(-1, 1) : Vec3{0.125f * static_cast<float>(i % 16) - 1, 0, 0.25f};
      const float sign = i % 4 < 2 ? 1.0f : -1.0f;
      add(origin, {axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : 0}, gpu::kFar);
    }
  return rays;
}

float nearest(const Triangles& triangles, const StructureRay& ray) {
  const bvh::PreparedRay prepared = bvh::prepare(
      {{ray.origin.x, ray.origin.y, ray.origin.z}, {ray.direction.x, ray.direction.y, ray.direction.z}, ray.t_max});
  float t = std::numeric_limits<float>::infinity();
  for (const bvh::Triangle& triangle : triangles) {
    bvh::TriangleHit hit;
    if (!bvh::has_no_area(triangle) && bvh::intersect(prepared, triangle, hit) && hit.t < ray.t_max)
      t = std::min(t, hit.t);
  }
  return t;
}

class Structures : public testing::TestWithParam<std::size_t> {
protected:
  void SetUp() override { end_test_without_device(test_device().problem); }
  const StructureKind& kind() const { return structure_kinds()[GetParam()]; }
};

// Traces the rays by a structure over the triangles, for the closest hit and for any, and compares with `expected`.
void expect_hits(DeviceStructure& structure, const std::vector<StructureRay>& rays, const std::vector<float>& expected,
                 const std::string& what) {
  EXPECT_GE(structure.trace(rays, false), 0.0);
  const std::vector<float> closest = structure.distances();
  structure.trace(rays, true);
  const std::vector<float> any = structure.distances();
  std::size_t hits = 0, other = 0, misjudged = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    hits += expected[i] < gpu::kFar;
    other += closest[i] != expected[i];
    misjudged += (any[i] < gpu::kFar) != (expected[i] < gpu::kFar);
  }
  EXPECT_GT(hits, 50u) << what;
  EXPECT_EQ(other, 0u) << what << ", " << hits << " hits";
  EXPECT_EQ(misjudged, 0u) << what;
}

TEST_P(Structures, FindWhatEveryTriangleTellsThem) {
  const std::vector<StructureRay> rays = all_rays();
  for (const Triangles& triangles :
       {mixture(), soup(3000, 0.2f, 7), square(), soup(1, 1.0f, 8), Triangles(200, square()[0])}) {
    std::vector<float> expected;
    for (const StructureRay& ray : rays) expected.push_back(nearest(triangles, ray));
    const Structure built = kind().build({.triangles = triangles, .rays = rays});
    DeviceStructure structure(*test_device().device, kind().spirv, built, triangles);
    expect_hits(structure, rays, expected, fmt::format("{}, {} triangles", kind().name, triangles.size()));
  }
}

TEST_P(Structures, StayWithinTheKernelsStacks) {
  Triangles hard(2000, square()[0]); // all in one place,
  for (int i = 0; i < 60; ++i) {     // and each half as large as the one before
    const float size = std::ldexp(1.0f, -i);
    hard.push_back({{1 + size, 0, 0}, {1 + 2 * size, 0, 0}, {1 + size, size, size}});
  }
  const Structure built = kind().build({.triangles = hard});
  EXPECT_LT(built.depth, std::string_view(kind().name) == "octree" ? 16u : 64u);
  std::set<std::uint32_t> held(built.items.begin(), built.items.end());
  EXPECT_EQ(
      held.size(), hard.size() - [&] {
        std::size_t flat = 0;
        for (const bvh::Triangle& triangle : hard) flat += bvh::has_no_area(triangle);
        return flat;
      }());
}

INSTANTIATE_TEST_SUITE_P(All, Structures, testing::Range<std::size_t>(0, structure_kinds().size()));

const StructureKind& wide_kind() { return structure_kinds()[0]; }

class WideTraversal : public testing::Test {
protected:
  void SetUp() override { end_test_without_device(test_device().problem); }
};

// Triangles that all lie across each other, so that rays enter nearly every child and stacks fill.
TEST_F(WideTraversal, FindsTheSameWhereverItsStackIs) {
  const Triangles triangles = soup(20000, 3.0f, 12);
  std::vector<StructureRay> rays = all_rays();
  rays.resize(400);
  std::vector<float> expected;
  for (const StructureRay& ray : rays) expected.push_back(nearest(triangles, ray));
  const Structure built = build_wide_bvh(triangles, bvh::Quality::balanced);
  bvh::Counters work[2];
  for (const bool in_registers : {false, true}) {
    DeviceStructure structure(*test_device().device, wide_kind().spirv, built, triangles);
    structure.put_stack_in_registers(in_registers);
    expect_hits(structure, rays, expected, in_registers ? "registers" : "array");
    work[in_registers] = structure.count(rays, false);
    EXPECT_GT(work[in_registers].visits, 100 * rays.size());
    EXPECT_GT(work[in_registers].tests, work[in_registers].visits);
  }
  // A lane whose registers are full stops, so that it tests what it has met earlier.
  EXPECT_NEAR(static_cast<double>(work[0].visits), static_cast<double>(work[1].visits), 0.1 * work[0].visits);
}

// A single triangle is one node and one test to a ray that comes near it; of many, eight children a node save visits.
TEST_F(WideTraversal, CountsItsWork) {
  const std::vector<StructureRay> rays = {{{0.5f, -0.5f, 2}, gpu::kFar, {0, 0, -1}}, {{5, 5, 2}, gpu::kFar, {0, 0, 1}}};
  const Triangles one(1, square()[0]);
  DeviceStructure structure(*test_device().device, wide_kind().spirv, build_wide_bvh(one, bvh::Quality::fast), one);
  const bvh::Counters work = structure.count(rays, false);
  EXPECT_EQ(work.visits, 1u);
  EXPECT_EQ(work.tests, 1u);

  const Triangles many = soup(5000, 0.1f, 4);
  DeviceStructure wide(*test_device().device, wide_kind().spirv, build_wide_bvh(many, bvh::Quality::fast), many);
  DeviceStructure binary(*test_device().device, structure_kinds()[1].spirv, build_sah_bvh(many), many);
  EXPECT_LT(3 * wide.count(all_rays(), false).visits, 2 * binary.count(all_rays(), false).visits);
}

class LightBuffer : public testing::Test {
protected:
  void SetUp() override { end_test_without_device(test_device().problem); }
};

// Rays from everywhere to the lamp, some from next to it, as the product's shadow rays are.
std::vector<StructureRay> rays_to(Vec3 lamp) {
  Random random(21);
  std::vector<StructureRay> rays;
  for (int i = 0; i < 500; ++i) {
    const Vec3 origin = i % 10 == 0 ? lamp + random.direction() * 0.01f : random.point(-1.5f, 1.5f),
               way = lamp - origin;
    rays.push_back({{origin.x, origin.y, origin.z}, 1.0f, {way.x, way.y, way.z}});
  }
  for (int axis = 0; axis < 3; ++axis) // on the borders of cells and of faces
    for (int i = 0; i < 66; ++i) {
      float way[3] = {0.0625f * static_cast<float>(i % 33 - 16), i % 2 == 0 ? 1.0f : 0.0f, i < 33 ? 1.0f : -1.0f};
      std::rotate(way, way + axis, way + 3);
      rays.push_back({{lamp.x - way[0], lamp.y - way[1], lamp.z - way[2]}, 1.0f, {way[0], way[1], way[2]}});
    }
  return rays;
}

// Which rays are blocked, to the last one, wherever the lamp is: among triangles, outside, and on one of them.
TEST_F(LightBuffer, AnswersAsEveryTriangleDoes) {
  for (const Triangles& triangles :
       {mixture(), soup(800, 0.3f, 7), soup(40, 3.0f, 3), square(), Triangles(200, square()[0])}) {
    std::size_t blocked = 0;
    for (const Vec3 lamp : {Vec3{0.1f, 0.2f, 0.3f}, Vec3{0, 0, 4}, Vec3{0.25f, -0.5f, 0}, Vec3{-30, 20, 10}}) {
      const std::vector<StructureRay> rays = rays_to(lamp);
      const Structure built = light_buffer_kind().build({.triangles = triangles, .lamp = {lamp.x, lamp.y, lamp.z}});
      DeviceStructure structure(*test_device().device, light_buffer_kind().spirv, built, triangles);
      structure.trace(rays, true);
      const std::vector<float> found = structure.distances();
      std::size_t misjudged = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const bool expected = nearest(triangles, rays[i]) < gpu::kFar;
        blocked += expected;
        misjudged += (found[i] < gpu::kFar) != expected;
      }
      EXPECT_EQ(misjudged, 0u) << triangles.size() << " triangles, lamp at " << lamp.x;
    }
    EXPECT_GT(blocked, 50u) << triangles.size();
  }
}

// A wall that fills a cell ends its list; without the wall all the triangles behind it are listed.
TEST(LightBufferLists, EndAtWhatClosesThem) {
  Triangles triangles = soup(500, 0.05f, 2);
  const Structure open = build_light_buffer({.triangles = triangles, .lamp = {0, 0, 9}});
  triangles.push_back({{-90, -90, 5}, {90, -90, 5}, {0, 90, 5}});
  const Structure closed = build_light_buffer({.triangles = triangles, .lamp = {0, 0, 9}});
  EXPECT_GT(std::set<std::uint32_t>(open.items.begin(), open.items.end()).size(), 490u);
  EXPECT_EQ(std::set<std::uint32_t>(closed.items.begin(), closed.items.end()), std::set<std::uint32_t>{500});
}

// Lists are sorted, and short where the rays are: far from all of the triangles.
TEST(RayClassification, HasShortSortedLists) {
  const Triangles triangles = soup(1500, 0.05f, 4);
  std::vector<StructureRay> rays = all_rays();
  rays.resize(500);
  const Structure tree = build_ray_classification({.triangles = triangles, .rays = rays});
  std::size_t lists = 0, longest = 0;
  for (std::size_t node = 0; 2 * node < tree.nodes.size(); ++node) {
    if ((tree.nodes[2 * node + 1] & 7u) != 7u) continue;
    const std::size_t first = tree.nodes[2 * node], count = tree.nodes[2 * node + 1] >> 3;
    lists += count > 0;
    longest = std::max(longest, count);
    EXPECT_TRUE(std::is_sorted(&tree.item_depths[first], &tree.item_depths[first] + count));
  }
  EXPECT_GT(lists, 50u);
  EXPECT_LE(longest, 512u);
  const Structure whole = build_ray_classification({.triangles = triangles});
  EXPECT_EQ(whole.items.size(), 6 * triangles.size());
}

// By its words alone, as kernels/bench/wide_bvh.comp has them: each triangle lies once in the boxes of all that holds
// it.
struct WideWalk {
  const Structure& tree;
  const Triangles& triangles;
  std::vector<std::size_t> held; // how often, by triangle
  std::size_t nodes = 0, outside = 0;

  std::uint32_t word(std::size_t node, std::size_t at) const { return tree.nodes[20 * node + at]; }
  float real(std::size_t node, std::size_t at) const { return std::bit_cast<float>(word(node, at)); }

  bvh::Box box_of(std::size_t node, std::uint32_t slot) const {
    float lo[3], hi[3];
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const float cell = std::ldexp(1.0f, static_cast<int>(word(node, 3) >> (7 * axis) & 127u) - 66);
      const auto plane = [&](std::size_t at) {
        const std::uint32_t number = word(node, at + slot / 4) >> (8 * (slot % 4)) & 255u;
        return real(node, axis) + static_cast<float>(number) * cell;
      };
      lo[axis] = plane(8 + 4 * axis), hi[axis] = plane(10 + 4 * axis);
    }
    return {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
  }

  void walk(std::size_t node, const std::vector<bvh::Box>& above) {
    ++nodes;
    std::uint32_t child = word(node, 4), item = word(node, 5);
    for (std::uint32_t slot = 0; slot < 8; ++slot) {
      std::vector<bvh::Box> boxes = above;
      boxes.push_back(box_of(node, slot));
      for (std::uint32_t k = 0; k < 3; ++k) {
        if (!(word(node, 6) >> (3 * slot + k) & 1u)) continue;
        const std::uint32_t triangle = tree.items[item++];
        ++held[triangle];
        for (const bvh::Box& box : boxes) outside += !bvh::contains(box, bvh::bounds(triangles[triangle]));
      }
      if (word(node, 6) >> (24 + slot) & 1u) walk(child++, boxes);
    }
  }
};

TEST(WideTree, HoldsEveryTriangleInItsBoxes) {
  for (const float scale : {1e-6f, 1.0f, 1e6f}) {
    Triangles triangles = soup(3000, 0.1f, 9);
    for (bvh::Triangle& triangle : triangles)
      triangle = {triangle.v0 * scale, triangle.v1 * scale, triangle.v2 * scale};
    const Structure tree = build_wide_bvh(triangles, bvh::Quality::fast);
    WideWalk walk{tree, triangles, std::vector<std::size_t>(triangles.size())};
    walk.walk(0, {});
    EXPECT_EQ(std::set<std::size_t>(walk.held.begin(), walk.held.end()), std::set<std::size_t>{1});
    EXPECT_EQ(walk.outside, 0u);
    EXPECT_EQ(20 * walk.nodes, tree.nodes.size());
    EXPECT_GT(static_cast<double>(walk.nodes), 3000.0 / 24);
  }
}

// The collapse fills nodes: less than half as many as the 4-wide tree has.
TEST(WideTree, HasFewNodes) {
  const Triangles triangles = soup(5000, 0.1f, 4);
  const std::size_t wide = build_wide_bvh(triangles, bvh::Quality::best).nodes.size() / 20;
  const std::size_t narrow = bvh::build(triangles, {.quality = bvh::Quality::best}).nodes.size();
  EXPECT_LT(2 * wide, narrow);
}

TEST(WideTree, IsBuiltOfNothing) {
  for (const Triangles& triangles : {Triangles{}, Triangles{{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}}}) {
    const Structure tree = build_wide_bvh(triangles, bvh::Quality::best);
    EXPECT_EQ(tree.nodes.size(), 20u);
    EXPECT_TRUE(tree.items.empty());
  }
}

TEST(StructureBoxes, OverlapAsTheirPartsAre) {
  Random random(11);
  std::size_t touching = 0;
  for (int i = 0; i < 20000; ++i) {
    const bvh::Triangle triangle = soup(1, 1.5f, static_cast<unsigned>(i))[0];
    const Vec3 lo = random.point(-1, 1);
    const bvh::Box box{lo, lo + random.point(0.01f, 0.7f)};
    const auto part = clip(triangle, box);
    EXPECT_EQ(part.has_value(), overlaps(triangle, box)) << i;
    if (!part) continue;
    ++touching;
    EXPECT_TRUE(bvh::contains({box.lo - Vec3{1e-5f, 1e-5f, 1e-5f}, box.hi + Vec3{1e-5f, 1e-5f, 1e-5f}}, *part));
  }
  EXPECT_GT(touching, 500u);
}

// Many cells where triangles are small, few where there are none to part.
TEST(StructureBoxes, GridsHaveAboutFourCellsATriangle) {
  const Structure grid = build_uniform_grid(soup(10000, 0.05f, 1));
  const double cells = double{1} * grid.resolution.x * grid.resolution.y * grid.resolution.z;
  EXPECT_NEAR(cells, 40000.0, 4000.0);
  const Structure flat = build_uniform_grid(square());
  EXPECT_EQ(flat.resolution.z, 1u);
  EXPECT_EQ(flat.nodes.size(), std::size_t{flat.resolution.x} * flat.resolution.y + 1);
}

// The product's binary tree keeps every triangle once; Morton codes order them along a curve.
TEST(StructureBoxes, BinaryTreesHoldTrianglesOnce) {
  const Triangles triangles = soup(5000, 0.1f, 4);
  for (const Structure& tree : {build_sah_bvh(triangles), build_linear_bvh(triangles)}) {
    EXPECT_EQ(tree.items.size(), triangles.size());
    EXPECT_EQ(std::set<std::uint32_t>(tree.items.begin(), tree.items.end()).size(), triangles.size());
    EXPECT_LT(tree.depth, bvh::kMaxBinaryDepth);
  }
}

} // namespace
} // namespace wavepath::test
