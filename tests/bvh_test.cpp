// The BVH builder gives valid trees on any input, and the validator finds what is not valid.
#include <array>
#include <cstring>
#include <numbers>

#include <tbb/global_control.h>

#include "bvh/coverage.h"
#include "bvh/measure.h"
#include "bvh/primitives.h"
#include "bvh/reinsert.h"
#include "bvh/traverse.h"
#include "tests/meshes.h"

namespace wavepath::bvh {
namespace {

// ---- building
// -------------------------------------------------------------------------------------------------------------

using Build = PerQuality;
INSTANTIATE_TEST_SUITE_P(Qualities, Build, ::testing::ValuesIn(kQualities), name_of);

TEST_P(Build, RandomSoupIsValidForEveryLeafSize) {
  const Triangles triangles = soup(20'000, 1);
  for (std::uint32_t size = 1; size <= kMaxLeafSize; ++size) {
    const Mesh mesh = build_checked(triangles, config(size));
    const Measure measured = measure(mesh.tree);
    EXPECT_GE(measured.item_count, triangles.size());
    for (std::uint32_t larger = size + 1; larger <= kMaxLeafSize; ++larger) EXPECT_EQ(measured.leaf_sizes[larger], 0u);
    EXPECT_LE(mesh.tree.depth, 20u);
  }
}

TEST_P(Build, TreeIsMuchCheaperThanTestingEverything) {
  const Triangles triangles = soup(100'000, 2, 0.01f);
  const Mesh mesh = build_checked(triangles, config());
  const Measure measured = measure(mesh.tree);
  EXPECT_LT(measured.sah_cost, 100.0);
  EXPECT_GT(measured.children_per_node, 2.5);
  Random random(3);
  Counters counters;
  for (int i = 0; i < 1000; ++i)
    closest_hit(mesh.tree, mesh.triangles, {random.point(), random.direction()}, &counters);
  EXPECT_LT(counters.visits, 40u * 1000u);
  EXPECT_LT(counters.tests, 40u * 1000u);
}

TEST_P(Build, NoneOneAndTwo) {
  const Mesh none = build_checked({}, config());
  EXPECT_EQ(none.tree.nodes.size(), 1u);
  EXPECT_EQ(closest_hit(none.tree, none.triangles, {{0, 0, -1}, {0, 0, 1}}).item, kAbsent);
  const Triangle triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Triangle behind{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  for (const Triangles& triangles : {Triangles{triangle}, Triangles{triangle, behind}, Triangles{behind, triangle}}) {
    const Mesh mesh = build_checked(triangles, config());
    const Hit hit = closest_hit(mesh.tree, mesh.triangles, {{0.25f, 0.25f, -1}, {0, 0, 1}});
    ASSERT_NE(hit.item, kAbsent);
    EXPECT_EQ(hit.triangle.t, 1.0f);
    EXPECT_EQ(closest_hit(mesh.tree, mesh.triangles, {{0.75f, 0.75f, -1}, {0, 0, 1}}).item, kAbsent);
  }
}

TEST_P(Build, SameBytesForAnyThreadCount) {
  const Triangles triangles = soup(300'000, 4);
  std::vector<WideTree> trees;
  for (const std::size_t threads : {1u, 2u, 7u}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    trees.push_back(build(std::span(triangles), config()));
  }
  for (const WideTree& tree : trees) {
    EXPECT_EQ(tree.order, trees[0].order);
    EXPECT_EQ(tree.depth, trees[0].depth);
    ASSERT_EQ(tree.nodes.size(), trees[0].nodes.size());
    EXPECT_EQ(std::memcmp(tree.nodes.data(), trees[0].nodes.data(), tree.nodes.size() * sizeof(WideNode)), 0);
  }
}

TEST_P(Build, Duplicates) {
  const Triangle triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Mesh mesh = build_checked(Triangles(10'000, triangle), config());
  EXPECT_LE(mesh.tree.depth, 8u);
  const Hit hit = closest_hit(mesh.tree, mesh.triangles, {{0.25f, 0.25f, 1}, {0, 0, -1}});
  EXPECT_EQ(mesh.tree.order[hit.item], 0u);
}

TEST_P(Build, DegenerateTriangles) {
  Triangles triangles = soup(1000, 5);
  for (std::size_t i = 0; i < triangles.size(); i += 2) {
    Triangle& t = triangles[i];
    if (i % 3 == 0) t = {t.v0, t.v0, t.v0};
    if (i % 3 == 1) t.v2 = t.v1;
    if (i % 3 == 2) t = {t.v0, t.v0 + Vec3{0.25f, 0, 0}, t.v0 + Vec3{0.5f, 0, 0}}; // on a line
  }
  const Mesh mesh = build_checked(triangles, config());
  EXPECT_EQ(mesh.report.dropped, 500u);
  for (const std::uint32_t index : mesh.tree.order) EXPECT_EQ(index % 2, 1u);
  Random random(6);
  for (const Triangle& triangle : triangles) { // even tested directly, points and repeated vertices are never hit
    const Vec3 origin = random.point(-1, 2);
    TriangleHit hit;
    const PreparedRay ray = prepare({origin, triangle.v1 - origin});
    EXPECT_FALSE(intersect(ray, {triangle.v0, triangle.v1, triangle.v1}, hit));
    EXPECT_FALSE(intersect(ray, {triangle.v1, triangle.v0, triangle.v1}, hit));
    EXPECT_FALSE(intersect(ray, {triangle.v1, triangle.v1, triangle.v1}, hit));
  }
}

TEST_P(Build, EqualCentroids) {
  Triangles triangles; // nested, all around the origin
  for (int i = 1; i <= 100'000; ++i) {
    const float r = static_cast<float>(i) * 0x1p-16f;
    triangles.push_back({{-r, -r, -r}, {r, r, -r}, {r, r, r}});
  }
  const Mesh mesh = build_checked(triangles, config());
  // Boxes in boxes are cheapest in a chain, which reinsertion finds and the depth budget ends.
  EXPECT_LE(mesh.tree.depth, GetParam() == Quality::fast ? 20u : kMaxDepth);
}

TEST_P(Build, GeometricProgression) {
  for (const int copies : {1, 50}) {
    Triangles triangles;
    for (int copy = 0; copy < copies; ++copy)
      for (int k = 0; k <= 50; ++k) {
        const float r = std::ldexp(1.0f, -k);
        triangles.push_back({{r, 0, 0}, {r * 1.25f, r * 0.25f, 0}, {r * 1.25f, 0, r * 0.25f}});
      }
    const Mesh mesh = build_checked(triangles, config(1));
    EXPECT_LE(mesh.report.binary_depth, 64u);
    EXPECT_LE(mesh.tree.depth, kMaxDepth);
  }
}

TEST(BuildSpatial, HalvesTheWorkAmongLongTriangles) {
  const Triangles triangles = straws(2000, 12);
  const Mesh fast = build_checked(triangles), best = build_checked(triangles, {.quality = Quality::best});
  EXPECT_GT(best.tree.order.size(), triangles.size());
  Random random(13);
  Counters with, without;
  for (int i = 0; i < 1000; ++i) {
    const Ray ray{random.point(), random.direction()};
    const Hit a = closest_hit(best.tree, best.triangles, ray, &with);
    const Hit b = closest_hit(fast.tree, fast.triangles, ray, &without);
    ASSERT_EQ(a.triangle.t, b.triangle.t);
  }
  EXPECT_LT(static_cast<double>(with.visits + with.tests), 0.5 * static_cast<double>(without.visits + without.tests));
}

// Slivers all over a disc, a triangle each, among a hundred times as many small ones that gain nothing by splits.
TEST(BuildSpatial, CopiesGoWhereTheySave) {
  constexpr int kSlivers = 128;
  Triangles triangles = soup(100 * kSlivers, 17, 0.01f);
  const auto corner = [](int i) {
    const double angle = 2.0 * std::numbers::pi * i / kSlivers;
    return Vec3{static_cast<float>(0.5 + 0.5 * std::cos(angle)), 2, static_cast<float>(0.5 + 0.5 * std::sin(angle))};
  };
  for (int i = 1; i + 1 < kSlivers; ++i) triangles.push_back({corner(0), corner(i), corner(i + 1)});
  const Mesh mesh = build_checked(triangles, {.quality = Quality::best});
  EXPECT_GT(mesh.tree.order.size(), triangles.size() + 4 * kSlivers);
  Random random(18);
  Counters counters;
  constexpr int kRays = 1000;
  for (int i = 0; i < kRays; ++i) {
    const Vec3 from = random.point();
    const Ray ray{{0.25f + 0.5f * from.x, 3, 0.25f + 0.5f * from.z}, {0, -1, 0}};
    const Hit hit = closest_hit(mesh.tree, mesh.triangles, ray, &counters);
    ASSERT_EQ(hit.triangle.t, 1.0f);
  }
  EXPECT_LT(counters.tests, 6u * kRays); // 28 where copies are shared out by counts
}

TEST(BuildSpatial, MakesNoMoreCopiesThanAllowed) {
  const Triangles triangles = straws(1000, 14);
  std::size_t fewer = 0;
  for (const double most : {0.0, 0.01, 0.1, 0.5, 2.0}) {
    const Mesh mesh = build_checked(triangles, {.quality = Quality::best, .max_copies = most});
    EXPECT_GE(mesh.tree.order.size(), fewer);
    fewer = mesh.tree.order.size();
  }
  EXPECT_EQ(build(std::span(triangles), {.quality = Quality::best, .max_copies = 0}).order.size(), triangles.size());
}

// Without copies both are the plain tree after reinsertion.
TEST(BuildSpatial, IsReinserted) {
  const Triangles triangles = straws(1000, 14);
  const auto order = [&](Quality quality) {
    return build(std::span(triangles), {.quality = quality, .max_copies = 0}).order;
  };
  EXPECT_EQ(order(Quality::balanced), order(Quality::best));
  EXPECT_NE(order(Quality::balanced), order(Quality::fast));
}

// Of the inner nodes, and the first items of the leaves.
std::pair<double, std::vector<std::uint32_t>> describe(const BinaryTree& tree) {
  double area = 0.0;
  std::vector<std::uint32_t> leaves, open{0};
  while (!open.empty()) {
    const BinaryNode& node = tree.nodes[open.back()];
    open.pop_back();
    if (node.item_count != 0) {
      leaves.push_back(node.first);
      continue;
    }
    area += half_area(node.box);
    open.insert(open.end(), {node.first, node.first + 1});
  }
  std::sort(leaves.begin(), leaves.end());
  return {area, leaves};
}

TEST(Reinsertion, KeepsTheLeavesAndTakesArea) {
  for (const Triangles& triangles : {soup(20'000, 15), straws(2000, 16), sphere(60, 90, 0.2f)}) {
    BuildReport report;
    const auto binary = [&] { return build_binary(boxes_of(triangles), {}, {}, report); };
    const auto [area, leaves] = describe(binary());
    const auto [area_after, leaves_after] = describe(reinsert(binary()));
    EXPECT_EQ(leaves_after, leaves);
    EXPECT_LT(area_after, area);
  }
}

// Nested cubes over 159 octaves: cuts by area peel off an octave or two each, and only the depth budget ends that.
TEST(BuildBoxes, DepthIsBoundedWhereAreaCutsPeel) {
  std::vector<Box> boxes;
  for (int octave = -99; octave < 60; ++octave)
    for (int copy = 0; copy < 100; ++copy) {
      const float x = std::ldexp(1.0f, octave);
      boxes.push_back({{0, 0, 0}, {x, x, x}});
    }
  BuildReport report;
  const WideTree tree = build(boxes, {.max_leaf_size = 1, .bin_count = 2}, &report);
  EXPECT_TRUE(validate(tree, boxes).empty());
  EXPECT_EQ(report.binary_depth, 64u);
  EXPECT_LE(tree.depth, kMaxDepth);
}

TEST(BuildBoxes, MillionInALine) {
  std::vector<Box> boxes;
  for (int i = 0; i < 1'000'000; ++i) {
    const float x = static_cast<float>(i);
    boxes.push_back({{x, 0, 0}, {x + 1, 0, 0}});
  }
  const WideTree tree = build(boxes);
  EXPECT_TRUE(validate(tree, boxes).empty());
  EXPECT_LE(tree.depth, 12u);
}

TEST_P(Build, DropsWhatIsNotANumber) {
  const Triangles clean = soup(5000, 8);
  Triangles dirty, survivors;
  Random random(9);
  for (const Triangle& triangle : clean) {
    dirty.push_back(triangle);
    if (random.uniform() < 0.01f) {
      const float bad[] = {kNan, kInf, -kInf, 1e30f};
      dirty.back().v1.y = bad[dirty.size() % 4];
    } else {
      survivors.push_back(triangle);
    }
  }
  const Mesh cleaned = build_checked(survivors, config()), mesh = build_checked(dirty, config());
  EXPECT_EQ(mesh.report.dropped, dirty.size() - survivors.size());
  EXPECT_GT(mesh.report.dropped, 10u);
  ASSERT_EQ(mesh.tree.nodes.size(), cleaned.tree.nodes.size());
  EXPECT_EQ(std::memcmp(mesh.tree.nodes.data(), cleaned.tree.nodes.data(), mesh.tree.nodes.size() * sizeof(WideNode)),
            0);
}

TEST(BuildBoxes, DropsInvertedOnes) {
  const std::vector<Box> inverted{{{1, 0, 0}, {0, 1, 1}}, {{0, 0, 0}, {1, 1, 1}}};
  BuildReport report;
  EXPECT_TRUE(validate(build(inverted, {}, &report), inverted).empty());
  EXPECT_EQ(report.dropped, 1u);
}

TEST_P(Build, SlabsOfAnyScaleGiveTheSameTree) {
  const Triangles triangles = soup(3000, 10);
  const WideTree unit = build(std::span(triangles), config());
  for (const float factor : {0x1p-40f, 0x1p-10f, 0x1p10f, 0x1p40f})
    EXPECT_EQ(build_checked(scaled(triangles, factor), config()).tree.order, unit.order) << factor;
}

// ---- what a build is made of: short cuts find what the long way finds
// -------------------------------------------------------------------------------------------------------------

void expect_same_bound(const Bound& found, const Bound& expected) {
  for (const int lane : {0, 1, 2, 4, 5, 6}) EXPECT_EQ(found.lane[lane], expected.lane[lane]) << "lane " << lane;
}

void expect_same_cut(const Cut& found, const Cut& expected) {
  ASSERT_EQ(found.left_count, expected.left_count);
  if (expected.left_count == 0) return;
  EXPECT_EQ(found.cost, expected.cost);
  EXPECT_EQ(found.axis, expected.axis);
  EXPECT_EQ(found.slab, expected.slab);
  expect_same_bound(found.left, expected.left);
  expect_same_bound(found.right, expected.right);
}

// Coordinates of few values, so that centroids coincide on one axis, on two, on all.
TEST(Cuts, OfTwoAndThreeAreThoseOfBins) {
  Random random(12);
  int undivided = 0;
  for (int i = 0; i < 20'000; ++i) {
    const std::size_t count = i % 2 == 0 ? 2 : 3;
    const float steps = i % 3 == 0 ? 2.0f : i % 3 == 1 ? 8.0f : 1e6f;
    const auto coarse = [&](Vec3 p) {
      return Vec3{std::round(p.x * steps), std::round(p.y * steps), std::round(p.z * steps)};
    };
    std::array<Primitive, 3> items;
    Bound bound, centroids;
    for (std::size_t k = 0; k < count; ++k) {
      const Vec3 a = coarse(random.point()), b = coarse(random.point());
      items[k] = Primitive(Box{min(a, b), max(a, b)}, static_cast<std::uint32_t>(k));
      bound.merge(items[k].bound);
      centroids.merge(items[k].centroid_bound());
    }
    const Slabs slabs(bound, centroids, 2);
    Bins bins(slabs);
    bins.add(slabs, {items.data(), count});
    const Cut expected = bins.best_cut(slabs);
    undivided += expected.left_count == 0;
    SCOPED_TRACE(i);
    expect_same_cut(count == 2 ? best_cut_of_two(slabs, items[0], items[1]) : best_cut_of_three(slabs, items),
                    expected);
    if (HasFailure()) return;
  }
  EXPECT_GT(undivided, 10);
}

// By vectors from triangles, and from their boxes one by one, with those that are dropped: the same, bit by bit.
TEST(Primitives, OfTrianglesAreThoseOfTheirBoxes) {
  Triangles triangles = soup(40'000, 5);
  Random random(6);
  const std::array<float, 5> broken = {kInf, -kInf, std::numeric_limits<float>::quiet_NaN(), 3e38f, -3e38f};
  for (std::size_t i = 0; i < triangles.size(); i += 7) {
    Triangle& t = triangles[i];
    const int kind = static_cast<int>(random.uniform(0, 9));
    float* const coordinate = &std::array{&t.v0, &t.v1, &t.v2}[static_cast<std::size_t>(random.uniform(0, 2.99f))]->y;
    if (kind < 5) *coordinate = broken[static_cast<std::size_t>(kind)];
    if (kind == 5) t.v2 = t.v1;                        // a line
    if (kind == 6) t.v2 = t.v0 + (t.v1 - t.v0) * 0.5f; // nearly one
    if (kind == 7) t = {t.v0 * 1e-30f, t.v1 * 1e-30f, t.v2 * 1e-30f};
    if (kind == 8) t.v1 = t.v2 = t.v0; // a point
  }
  const std::vector<Box> boxes = boxes_of(triangles);
  std::vector<Primitive> found(triangles.size()), expected(triangles.size());
  const PrimitiveList of_triangles = list_primitives(triangles, found.data());
  const PrimitiveList of_boxes = list_primitives(boxes, expected.data());
  ASSERT_EQ(of_triangles.count, of_boxes.count);
  EXPECT_LT(of_boxes.count, triangles.size() - 1000);
  expect_same_bound(of_triangles.bound, of_boxes.bound);
  expect_same_bound(of_triangles.centroids, of_boxes.centroids);
  for (std::size_t i = 0; i < of_boxes.count; ++i) {
    ASSERT_EQ(found[i].index(), expected[i].index());
    expect_same_bound(found[i].bound, expected[i].bound);
    if (HasFailure()) return;
  }
}

// ---- validate
// -------------------------------------------------------------------------------------------------------------

TEST(Validate, ReportsEveryKindOfDamage) {
  const std::vector<Box> boxes = boxes_of(soup(500, 11));
  const WideTree good = build(boxes);
  ASSERT_TRUE(validate(good, boxes).empty());
  ASSERT_GT(good.nodes.size(), 8u);
  const auto damaged = [&](auto&& damage) {
    WideTree tree = good;
    damage(tree);
    return !validate(tree, boxes).empty();
  };
  ASSERT_GT(inner_count(good.nodes[0]), 1u);
  ASSERT_GT(item_count(good.nodes.back(), 0), 0u);
  EXPECT_TRUE(damaged([&](WideTree& t) { --t.nodes[0].hi_x[0]; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { ++t.nodes.back().lo_z[0]; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes.back().hi_y[0] = 0; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes[0].origin[1] = kNan; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes[0].layout -= 1u; })); // cells of half the size
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes[0].first_child = 0; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes[0].first_child = static_cast<std::uint32_t>(t.nodes.size()); }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes[0].layout -= 1u << kInnerCountShift; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes[0].layout |= 1u << kItemCountShift; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes.back().first_item = 500u; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes.back().layout ^= 1u << kItemCountShift; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes.push_back(t.nodes.back()); }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.order[3] = t.order[4]; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.order[3] = 500; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { std::swap(t.order.front(), t.order.back()); }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.order.pop_back(); }));
  EXPECT_TRUE(damaged([&](WideTree& t) { ++t.depth; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { --t.depth; }));
}

// Two boxes of one triangle may each leave out some of it, but not both the same.
TEST(Validate, SeesWhatCopiesLeaveOut) {
  const Triangle triangle{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const GridBox left{{0, 0, 0}, {1, 4, 0}}, right{{1, 0, 0}, {4, 3, 0}}, low{{1.001, 0, 0}, {4, 3, 0}};
  EXPECT_TRUE(covered(triangle, std::array{left, right}));
  EXPECT_TRUE(covered(triangle, std::array{right, left}));
  EXPECT_FALSE(covered(triangle, std::array{left, low}));
  EXPECT_FALSE(covered(triangle, std::array{left}));
  EXPECT_FALSE(covered(triangle, std::span<const GridBox>{}));

  const Triangles triangles = straws(200, 15);
  const WideTree good = build(std::span(triangles), {.quality = Quality::best});
  ASSERT_GT(good.order.size(), triangles.size());
  ASSERT_TRUE(validate(good, triangles).empty());
  ASSERT_GT(item_count(good.nodes.back(), 0), 0u);
  for (const int plane : {0, 1, 2, 3, 4, 5}) {
    WideTree damaged = good;
    WideNode& node = damaged.nodes.back();
    std::uint8_t* planes[] = {node.lo_x, node.lo_y, node.lo_z, node.hi_x, node.hi_y, node.hi_z};
    planes[plane][0] = static_cast<std::uint8_t>(planes[plane][0] + (plane < 3 ? 3 : -3));
    EXPECT_FALSE(validate(damaged, triangles).empty()) << plane;
  }
}

// ---- the grid
// -------------------------------------------------------------------------------------------------------------

// Boxes of any size, place and flatness lie inside their boxes on the grid, with the margin, and those are tight.
TEST(Grid, ContainsItsBoxesAtEveryScale) {
  Random random(40);
  for (int i = 0; i < 200'000; ++i) {
    const float size = std::pow(10.0f, random.uniform(-6, 8)), offset = std::pow(10.0f, random.uniform(-6, 8));
    const Vec3 place = random.point(-1, 1) * offset;
    std::vector<Box> boxes(1 + static_cast<std::size_t>(random.uniform(0, 3.99f)));
    for (Box& box : boxes) {
      Vec3 a = place + random.point(-1, 1) * size, b = place + random.point(-1, 1) * size;
      if (random.uniform() < 0.2f) b.x = a.x;
      if (random.uniform() < 0.2f) b.y = a.y;
      if (random.uniform() < 0.1f) a.z = b.z = place.z;
      box = {min(a, b), max(a, b)};
    }
    const WideNode node = place_on_grid(boxes);
    for (int axis = 0; axis < 3; ++axis) {
      float lowest = kInf, highest = -kInf;
      for (const Box& box : boxes) {
        lowest = std::min(lowest, box.lo[axis]);
        highest = std::max(highest, box.hi[axis]);
      }
      const double size_of_cell = double{cell(node, axis)}, margin = kGridMargin * size_of_cell;
      for (std::uint32_t slot = 0; slot < boxes.size(); ++slot) {
        const GridBox box = child_box(node, slot);
        ASSERT_LE(box.lo[axis], boxes[slot].lo[axis] - margin);
        ASSERT_GE(box.hi[axis], boxes[slot].hi[axis] + margin);
        ASSERT_GE(box.lo[axis], boxes[slot].lo[axis] - size_of_cell - margin);
        ASSERT_LE(box.hi[axis], boxes[slot].hi[axis] + size_of_cell + margin);
      }
      // 255 cells hold the children and what the origin's last place adds; half as large ones would not.
      const float below = std::nextafter(lowest, -kInf);
      ASSERT_LE(size_of_cell * 120, std::max(double{highest} - below, 120 * 0x1p-66) * 1.01);
    }
  }
}

// A speck seen from far away: its inverted boxes would be within what the slab test forgives, but the counts tell.
TEST(Grid, AbsentChildrenAreNeverEntered) {
  const Triangle speck{{1, 1, 1}, {1 + 1e-6f, 1, 1}, {1, 1 + 1e-6f, 1}};
  const Mesh mesh = build_checked({speck});
  const PreparedRay ray = prepare({{1e4f, 1e4f, 1e4f}, {-1, -1, -1}});
  const Entered entered = enter_children(mesh.tree.nodes[0], ray, kInf);
  EXPECT_EQ(entered.inner, 0u);
  EXPECT_EQ(entered.leaves, 1u);
}

} // namespace
} // namespace wavepath::bvh
