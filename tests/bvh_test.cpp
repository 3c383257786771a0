// The BVH library: trees are sound on any input, and its traversal agrees with testing every triangle.
#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "bvh/build.h"
#include "bvh/measure.h"
#include "bvh/traverse.h"
#include "bvh/validate.h"

namespace wavepath::bvh {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

using Triangles = std::vector<Triangle>;

struct Random {
  std::mt19937 engine;
  explicit Random(unsigned seed) : engine(seed) {}
  float uniform(float lo = 0.0f, float hi = 1.0f) { return std::uniform_real_distribution<float>(lo, hi)(engine); }
  Vec3 point(float lo = 0.0f, float hi = 1.0f) { return {uniform(lo, hi), uniform(lo, hi), uniform(lo, hi)}; }
  Vec3 direction() {
    for (;;) {
      const Vec3 p = point(-1, 1);
      const float square = p.x * p.x + p.y * p.y + p.z * p.z;
      if (square > 0.01f && square < 1.0f) return p * (1 / std::sqrt(square));
    }
  }
};

std::vector<Box> boxes_of(const Triangles& triangles) {
  std::vector<Box> boxes;
  for (const Triangle& triangle : triangles) boxes.push_back(bounds(triangle));
  return boxes;
}

// A tree with its triangles in leaf order.
struct Mesh {
  WideTree tree;
  Triangles triangles;
  BuildReport report;
};

// Builds, and fails the test unless the tree is valid.
Mesh build_checked(const Triangles& triangles, const BuildConfig& config = {}) {
  const std::vector<Box> boxes = boxes_of(triangles);
  Mesh mesh;
  mesh.tree = build(boxes, config, &mesh.report);
  for (const std::string& reason : validate(mesh.tree, boxes)) ADD_FAILURE() << reason;
  for (std::uint32_t index : mesh.tree.order) mesh.triangles.push_back(triangles[index]);
  EXPECT_EQ(mesh.tree.order.size() + mesh.report.dropped, triangles.size());
  return mesh;
}

Triangles soup(int count, unsigned seed, float size = 0.05f) {
  Random random(seed);
  Triangles triangles;
  for (int i = 0; i < count; ++i) {
    const Vec3 center = random.point();
    triangles.push_back({center, center + random.point(-size, size), center + random.point(-size, size)});
  }
  return triangles;
}

// Closed; the radius wobbles by `roughness`, the poles are single vertices.
Triangles sphere(int rings, int segments, float roughness, Vec3 center = {}, float radius = 1.0f) {
  Random random(7);
  std::vector<Vec3> vertices;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < segments; ++j) {
      const float theta = std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(rings);
      const float phi = 2 * std::numbers::pi_v<float> * static_cast<float>(j) / static_cast<float>(segments);
      const float r = radius * (1 + roughness * random.uniform(-1, 1));
      vertices.push_back(center + Vec3{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)} * r);
    }
  const auto vertex = [&](int i, int j) {
    const int column = i == 0 || i == rings ? 0 : j % segments;
    return vertices[static_cast<std::size_t>(i * segments + column)];
  };
  Triangles triangles; // counter-clockwise seen from outside
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < segments; ++j) {
      if (i + 1 != rings) triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      if (i != 0) triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  return triangles;
}

Triangles scaled(Triangles triangles, float factor) {
  for (Triangle& t : triangles) t = {t.v0 * factor, t.v1 * factor, t.v2 * factor};
  return triangles;
}

Hit brute_force(const Triangles& triangles, const Ray& ray) {
  const PreparedRay prepared = prepare(ray);
  Hit hit;
  float t_best = ray.t_max;
  if (prepared.valid) test_leaf(prepared, triangles, 0, static_cast<std::uint32_t>(triangles.size()), t_best, hit);
  return hit;
}

Vec3 point_of(const Triangle& t, const TriangleHit& hit) {
  return t.v0 * (1 - hit.b1 - hit.b2) + t.v1 * hit.b1 + t.v2 * hit.b2;
}

void expect_same(const Hit& a, const Hit& b) {
  ASSERT_EQ(a.item, b.item);
  if (a.item != kAbsent) {
    ASSERT_EQ(a.triangle.t, b.triangle.t);
  }
}

// ---- building -------------------------------------------------------------------------------------------------------------

TEST(Build, RandomSoupIsValidForEveryLeafSize) {
  const Triangles triangles = soup(20'000, 1);
  for (std::uint32_t size = 1; size <= kMaxLeafSize; ++size) {
    const Mesh mesh = build_checked(triangles, {.max_leaf_size = size});
    const Measure measured = measure(mesh.tree);
    EXPECT_EQ(measured.item_count, triangles.size());
    for (std::uint32_t larger = size + 1; larger <= kMaxLeafSize; ++larger) EXPECT_EQ(measured.leaf_sizes[larger], 0u);
    EXPECT_LE(mesh.tree.stack_bound, 48u);
  }
}

TEST(Build, TreeIsMuchCheaperThanTestingEverything) {
  const Triangles triangles = soup(100'000, 2, 0.01f);
  const Mesh mesh = build_checked(triangles);
  const Measure measured = measure(mesh.tree);
  EXPECT_LT(measured.sah_cost, 100.0);
  EXPECT_GT(measured.children_per_node, 2.5);
  Random random(3);
  Counters counters;
  for (int i = 0; i < 1000; ++i) closest_hit(mesh.tree, mesh.triangles, {random.point(), random.direction()}, &counters);
  EXPECT_LT(counters.visits, 40u * 1000u);
  EXPECT_LT(counters.tests, 40u * 1000u);
}

TEST(Build, NoneOneAndTwo) {
  const Mesh none = build_checked({});
  EXPECT_EQ(none.tree.nodes.size(), 1u);
  EXPECT_EQ(closest_hit(none.tree, none.triangles, {{0, 0, -1}, {0, 0, 1}}).item, kAbsent);
  const Triangle triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Triangle behind{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  for (const Triangles& triangles : {Triangles{triangle}, Triangles{triangle, behind}, Triangles{behind, triangle}}) {
    const Mesh mesh = build_checked(triangles);
    const Hit hit = closest_hit(mesh.tree, mesh.triangles, {{0.25f, 0.25f, -1}, {0, 0, 1}});
    ASSERT_NE(hit.item, kAbsent);
    EXPECT_EQ(hit.triangle.t, 1.0f);
    EXPECT_EQ(closest_hit(mesh.tree, mesh.triangles, {{0.75f, 0.75f, -1}, {0, 0, 1}}).item, kAbsent);
  }
}

TEST(Build, SameBytesForAnyThreadCount) {
  const Triangles triangles = soup(300'000, 4);
  const std::vector<Box> boxes = boxes_of(triangles);
  std::vector<WideTree> trees;
  for (const std::size_t threads : {1u, 2u, 7u}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    trees.push_back(build(boxes));
  }
  for (const WideTree& tree : trees) {
    EXPECT_EQ(tree.order, trees[0].order);
    EXPECT_EQ(tree.root, trees[0].root);
    EXPECT_EQ(tree.stack_bound, trees[0].stack_bound);
    ASSERT_EQ(tree.nodes.size(), trees[0].nodes.size());
    EXPECT_EQ(std::memcmp(tree.nodes.data(), trees[0].nodes.data(), tree.nodes.size() * sizeof(WideNode)), 0);
  }
}

TEST(Build, Duplicates) {
  const Triangle triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Mesh mesh = build_checked(Triangles(10'000, triangle));
  EXPECT_LE(mesh.tree.stack_bound, 24u);
  const Hit hit = closest_hit(mesh.tree, mesh.triangles, {{0.25f, 0.25f, 1}, {0, 0, -1}});
  EXPECT_EQ(hit.item, 0u);
}

TEST(Build, DegenerateTriangles) {
  Triangles triangles = soup(1000, 5);
  for (std::size_t i = 0; i < triangles.size(); i += 2) {
    Triangle& t = triangles[i];
    if (i % 3 == 0) t = {t.v0, t.v0, t.v0};
    if (i % 3 == 1) t.v2 = t.v1;
    if (i % 3 == 2) t = {t.v0, t.v0 + Vec3{0.25f, 0, 0}, t.v0 + Vec3{0.5f, 0, 0}}; // on a line
  }
  const Mesh mesh = build_checked(triangles);
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

TEST(Build, EqualCentroids) {
  Triangles triangles; // nested, all around the origin
  for (int i = 1; i <= 100'000; ++i) {
    const float r = static_cast<float>(i) * 0x1p-16f;
    triangles.push_back({{-r, -r, -r}, {r, r, -r}, {r, r, r}});
  }
  const Mesh mesh = build_checked(triangles);
  EXPECT_LE(mesh.tree.stack_bound, 48u);
}

TEST(Build, GeometricProgression) {
  for (const int copies : {1, 50}) {
    Triangles triangles;
    for (int copy = 0; copy < copies; ++copy)
      for (int k = 0; k <= 50; ++k) {
        const float r = std::ldexp(1.0f, -k);
        triangles.push_back({{r, 0, 0}, {r * 1.25f, r * 0.25f, 0}, {r * 1.25f, 0, r * 0.25f}});
      }
    const Mesh mesh = build_checked(triangles, {.max_leaf_size = 1});
    EXPECT_LE(mesh.report.binary_depth, 64u);
    EXPECT_LE(mesh.tree.stack_bound, kMaxStackBound);
  }
}

// Boxes whose every cut by area peels off a single one: only the depth budget ends that.
TEST(Build, DepthIsBoundedWhereAreaCutsPeel) {
  std::vector<Box> boxes;
  for (int k = 0; k < 100'000; ++k) {
    const float x = std::pow(0.97f, static_cast<float>(k % 2000));
    boxes.push_back({{0, 0, 0}, {x, x, x}});
  }
  BuildReport report;
  const WideTree tree = build(boxes, {.max_leaf_size = 1}, &report);
  EXPECT_TRUE(validate(tree, boxes).empty());
  EXPECT_LE(report.binary_depth, 64u);
  EXPECT_LE(tree.stack_bound, kMaxStackBound);
}

TEST(Build, MillionInALine) {
  std::vector<Box> boxes;
  for (int i = 0; i < 1'000'000; ++i) {
    const float x = static_cast<float>(i);
    boxes.push_back({{x, 0, 0}, {x + 1, 0, 0}});
  }
  const WideTree tree = build(boxes);
  EXPECT_TRUE(validate(tree, boxes).empty());
  EXPECT_LE(tree.stack_bound, 36u);
}

TEST(Build, DropsWhatIsNotANumber) {
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
  const Mesh cleaned = build_checked(survivors), mesh = build_checked(dirty);
  EXPECT_EQ(mesh.report.dropped, dirty.size() - survivors.size());
  EXPECT_GT(mesh.report.dropped, 10u);
  ASSERT_EQ(mesh.tree.nodes.size(), cleaned.tree.nodes.size());
  EXPECT_EQ(std::memcmp(mesh.tree.nodes.data(), cleaned.tree.nodes.data(), mesh.tree.nodes.size() * sizeof(WideNode)), 0);
  const std::vector<Box> inverted{{{1, 0, 0}, {0, 1, 1}}, {{0, 0, 0}, {1, 1, 1}}};
  BuildReport report;
  EXPECT_TRUE(validate(build(inverted, {}, &report), inverted).empty());
  EXPECT_EQ(report.dropped, 1u);
}

TEST(Build, SlabsOfAnyScaleGiveTheSameTree) {
  const Triangles triangles = soup(3000, 10);
  const WideTree unit = build(boxes_of(triangles));
  for (const float factor : {0x1p-40f, 0x1p-10f, 0x1p10f, 0x1p40f})
    EXPECT_EQ(build(boxes_of(scaled(triangles, factor))).order, unit.order) << factor;
}

// ---- validate -------------------------------------------------------------------------------------------------------------

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
  const auto inner_slot = [&](const WideNode& node) {
    std::size_t slot = 0;
    while (slot < 4 && (node.child[slot] & kLeafBit) != 0) ++slot;
    return slot;
  };
  const std::size_t inner = inner_slot(good.nodes[0]);
  ASSERT_LT(inner, 4u);
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes[0].hi_x[inner] = std::nextafter(t.nodes[0].hi_x[inner], -1.0f); }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes.back().lo_z[0] += 1.0f; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes.back().hi_y[0] = kNan; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes[0].child[inner] = 0; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes[0].child[inner] = static_cast<std::uint32_t>(t.nodes.size()); }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes[0].child[inner] = kLeafBit | 500u; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes[0].child[inner] = kAbsent; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes.back().child[0] ^= 1u << kLeafCountShift; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.nodes.push_back(t.nodes.back()); }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.order[3] = t.order[4]; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.order[3] = 500; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { std::swap(t.order.front(), t.order.back()); }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.order.pop_back(); }));
  EXPECT_TRUE(damaged([&](WideTree& t) { ++t.stack_bound; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { --t.stack_bound; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.root = kAbsent; }));
  EXPECT_TRUE(damaged([&](WideTree& t) { t.root = 1; }));
  EXPECT_TRUE(damaged([&](WideTree& t) {
    for (WideNode& node : t.nodes)
      for (int slot = 0; slot < 4; ++slot)
        if (node.child[slot] == kAbsent) node.lo_x[slot] = -1.0f;
  }));
}

// ---- tracing --------------------------------------------------------------------------------------------------------------

TEST(Trace, ClosestHitEqualsBruteForceOverScales) {
  for (int exponent = -6; exponent <= 6; exponent += 2) {
    const float scale = std::pow(10.0f, static_cast<float>(exponent));
    const Mesh mesh = build_checked(scaled(soup(1000, 20, 0.2f), scale));
    Random random(static_cast<unsigned>(exponent + 40));
    int hits = 0;
    for (int i = 0; i < 10'000; ++i) {
      Ray ray{random.point(-0.5f, 1.5f) * scale, random.direction()};
      if (i % 3 == 0) ray.t_max = random.uniform(0, 1) * scale;
      if (i % 5 == 0) ray.direction = ray.direction * random.uniform(1e-3f, 1e3f);
      const Hit expected = brute_force(mesh.triangles, ray);
      expect_same(closest_hit(mesh.tree, mesh.triangles, ray), expected);
      ASSERT_EQ(any_hit(mesh.tree, mesh.triangles, ray), expected.item != kAbsent);
      hits += expected.item != kAbsent;
    }
    EXPECT_GT(hits, 1000);
  }
}

// Triangles whose size is log-uniform over twelve decades, seen from as many distances.
TEST(Trace, ClosestHitEqualsBruteForceInMixedScales) {
  Random random(21);
  Triangles triangles;
  for (int i = 0; i < 1000; ++i) {
    const float at = std::pow(10.0f, random.uniform(-6, 6)), size = std::pow(10.0f, random.uniform(-6, 6));
    const Vec3 center = random.direction() * at;
    triangles.push_back({center, center + random.direction() * size, center + random.direction() * size});
  }
  const Mesh mesh = build_checked(triangles);
  for (int i = 0; i < 20'000; ++i) {
    const Triangle& aim = triangles[static_cast<std::size_t>(random.uniform() * 999)];
    const float b1 = random.uniform() / 2, b2 = random.uniform() / 2;
    const Vec3 target = aim.v0 + (aim.v1 - aim.v0) * b1 + (aim.v2 - aim.v0) * b2;
    const Vec3 origin = random.direction() * std::pow(10.0f, random.uniform(-6, 6));
    const Ray ray{origin, target - origin};
    expect_same(closest_hit(mesh.tree, mesh.triangles, ray), brute_force(mesh.triangles, ray));
  }
}

TEST(Trace, TiesGoToTheLowestItem) {
  Triangles triangles = soup(2000, 22);
  const std::size_t count = triangles.size();
  for (std::size_t copy = 0; copy < 3; ++copy)
    for (std::size_t i = 0; i < count; ++i) triangles.push_back(triangles[i]);
  const Mesh mesh = build_checked(triangles);
  Random random(23);
  for (int i = 0; i < 3000; ++i) {
    const Ray ray{random.point(-1, 2), random.direction()};
    expect_same(closest_hit(mesh.tree, mesh.triangles, ray), brute_force(mesh.triangles, ray));
  }
}

TEST(Trace, BarycentricsAndDistanceGiveTheHitPoint) {
  const Mesh mesh = build_checked(soup(1000, 24));
  Random random(25);
  for (int i = 0; i < 10'000; ++i) {
    const Ray ray{random.point(-1, 2), random.direction()};
    const Hit hit = closest_hit(mesh.tree, mesh.triangles, ray);
    if (hit.item == kAbsent) continue;
    const Vec3 point = point_of(mesh.triangles[hit.item], hit.triangle);
    EXPECT_LT(max_component(abs(point - (ray.origin + ray.direction * hit.triangle.t))), 1e-5f);
  }
}

// Against the geometric normal in double, for every dominant axis and sign of the ray.
TEST(Trace, FrontIsCounterClockwise) {
  Random random(26);
  int front = 0, back = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Triangle t{random.point(-1, 1), random.point(-1, 1), random.point(-1, 1)};
    const Vec3 target = (t.v0 + t.v1 + t.v2) * (1 / 3.0f), origin = random.point(-3, 3);
    TriangleHit hit;
    if (!intersect(prepare({origin, target - origin}), t, hit)) continue;
    const Vec3 a = t.v1 - t.v0, b = t.v2 - t.v0, d = target - origin;
    const double nx = double{a.y} * b.z - double{a.z} * b.y, ny = double{a.z} * b.x - double{a.x} * b.z,
                 nz = double{a.x} * b.y - double{a.y} * b.x;
    const double facing = nx * d.x + ny * d.y + nz * d.z;
    if (std::fabs(facing) < 1e-5) continue;
    EXPECT_EQ(hit.front, facing < 0);
    ++(hit.front ? front : back);
  }
  EXPECT_GT(front, 5000);
  EXPECT_GT(back, 5000);
}

TEST(Trace, GarbageRaysMiss) {
  const Mesh mesh = build_checked(sphere(20, 40, 0.1f));
  for (const float bad : {kNan, kInf, -kInf, 1e30f})
    for (int component = 0; component < 6; ++component) {
      float values[6] = {0.1f, 0.1f, 0.1f, 0.5f, 0.6f, 0.7f};
      values[component] = bad;
      const Ray ray{{values[0], values[1], values[2]}, {values[3], values[4], values[5]}};
      Counters counters;
      EXPECT_EQ(closest_hit(mesh.tree, mesh.triangles, ray, &counters).item, kAbsent);
      EXPECT_FALSE(any_hit(mesh.tree, mesh.triangles, ray, &counters));
      EXPECT_EQ(counters.visits + counters.tests, 0u);
    }
  for (const float t_max : {kNan, 0.0f, -1.0f, -kInf})
    EXPECT_FALSE(any_hit(mesh.tree, mesh.triangles, {{}, {0, 0, 1}, t_max}));
  EXPECT_FALSE(any_hit(mesh.tree, mesh.triangles, {{}, {0, 0, 0}}));
}

TEST(Trace, DistanceBoundsAreOpen) {
  const Mesh mesh = build_checked({{{-1, -1, 1}, {1, -1, 1}, {0, 1, 1}}});
  const auto hit = [&](float z, float t_max) { return any_hit(mesh.tree, mesh.triangles, {{0, 0, z}, {0, 0, 1}, t_max}); };
  EXPECT_TRUE(hit(0, kInf));
  EXPECT_TRUE(hit(0, std::nextafter(1.0f, 2.0f)));
  EXPECT_FALSE(hit(0, 1.0f));
  EXPECT_FALSE(hit(1, kInf));
  EXPECT_TRUE(hit(std::nextafter(1.0f, 0.0f), kInf));
  EXPECT_FALSE(hit(2, kInf));
}

// Rays that run exactly along the faces of boxes, with zeros of both signs.
TEST(Trace, AxisAlignedRaysOnBoxFaces) {
  Triangles triangles; // a 16 x 16 grid of quads in the plane z = 0
  for (int i = 0; i < 16; ++i)
    for (int j = 0; j < 16; ++j) {
      const float x = static_cast<float>(i), y = static_cast<float>(j);
      triangles.push_back({{x, y, 0}, {x + 1, y, 0}, {x + 1, y + 1, 0}});
      triangles.push_back({{x, y, 0}, {x + 1, y + 1, 0}, {x, y + 1, 0}});
    }
  const Mesh mesh = build_checked(triangles, {.max_leaf_size = 1});
  for (const float zero : {0.0f, -0.0f})
    for (int i = -2; i <= 34; ++i)
      for (int j = -2; j <= 34; ++j) {
        const float x = static_cast<float>(i) / 2, y = static_cast<float>(j) / 2;
        const bool inside = i >= 0 && i <= 32 && j >= 0 && j <= 32;
        for (const float side : {-1.0f, 1.0f}) {
          const Ray ray{{x, y, 3 * side}, {zero, zero, -side}};
          const Hit hit = closest_hit(mesh.tree, mesh.triangles, ray);
          EXPECT_EQ(hit.item != kAbsent, inside);
          expect_same(hit, brute_force(mesh.triangles, ray));
        }
        const Ray along{{-5, y, 0}, {1, zero, zero}}; // within the plane: edge-on triangles are never hit
        EXPECT_EQ(closest_hit(mesh.tree, mesh.triangles, along).item, kAbsent);
      }
}

// ---- no leaks -------------------------------------------------------------------------------------------------------------

int count_leaks(const Mesh& mesh, Random& random, Vec3 center, float radius, int count) {
  int leaks = 0;
  const auto pick = [&]() -> const Triangle& {
    return mesh.triangles[static_cast<std::size_t>(random.uniform(0, 0.999f) * static_cast<float>(mesh.triangles.size()))];
  };
  for (int i = 0; i < count; ++i) {
    const Vec3 origin = center + random.direction() * (radius * random.uniform());
    const Triangle& aim = pick();
    const Vec3 on_edge = aim.v0 + (aim.v1 - aim.v0) * random.uniform();
    for (const Vec3 direction : {random.direction(), aim.v0 - origin, on_edge - origin})
      leaks += !any_hit(mesh.tree, mesh.triangles, {origin, direction});
  }
  return leaks;
}

TEST(Watertight, PerturbedSphere) {
  Random random(30);
  for (const std::uint32_t leaf_size : {1u, 4u})
    EXPECT_EQ(count_leaks(build_checked(sphere(100, 200, 0.02f), {.max_leaf_size = leaf_size}), random, {}, 0.9f, 50'000), 0);
}

TEST(Watertight, FarSphere) {
  Random random(31);
  const Vec3 center{148376, 1234, -223423};
  EXPECT_EQ(count_leaks(build_checked(sphere(50, 100, 0, center, 2)), random, center, 0.5f, 50'000), 0);
  EXPECT_EQ(count_leaks(build_checked(scaled(sphere(50, 100, 0.1f), 1e-6f)), random, {}, 0.5e-6f, 20'000), 0);
  EXPECT_EQ(count_leaks(build_checked(scaled(sphere(50, 100, 0.1f), 1e6f)), random, {}, 0.5e6f, 20'000), 0);
}

// A closed octahedron of eight large triangles, from points very near to an edge or a vertex, aimed at that edge.
TEST(Watertight, NearTheEdgeOfLargeTriangles) {
  const Triangles triangles = sphere(2, 4, 0.3f);
  ASSERT_EQ(triangles.size(), 8u);
  const Mesh mesh = build_checked(triangles, {.max_leaf_size = 1});
  Random random(32);
  int leaks = 0;
  for (int i = 0; i < 300'000; ++i) {
    const Triangle& t = triangles[static_cast<std::size_t>(random.uniform(0, 7.99f))];
    const float along = random.uniform();
    const Vec3 on_edge = t.v0 + (t.v1 - t.v0) * along;
    const Vec3 origin = on_edge * (1 - std::pow(10.0f, random.uniform(-4, -1)));
    leaks += !any_hit(mesh.tree, mesh.triangles, {origin, on_edge - origin});
    const Vec3 nearby = t.v0 + (t.v1 - t.v0) * (along + random.uniform(-1e-3f, 1e-3f));
    leaks += !any_hit(mesh.tree, mesh.triangles, {origin, nearby - origin});
  }
  EXPECT_EQ(leaks, 0);
}

// A disc of 10^6:1 slivers has no holes, seen from straight above or at a slant.
TEST(Watertight, FanOfSlivers) {
  constexpr int kCount = 2000;
  constexpr double kStep = 1e-6;
  const auto rim = [](int i) {
    return Vec3{static_cast<float>(std::cos(i * kStep)), static_cast<float>(std::sin(i * kStep)), 0.0f};
  };
  Triangles triangles;
  for (int i = 0; i < kCount; ++i) triangles.push_back({{0, 0, 0}, rim(i), rim(i + 1)});
  const Mesh mesh = build_checked(triangles);
  Random random(33);
  int leaks = 0;
  for (int i = 0; i < 50'000; ++i) {
    const float angle = random.uniform(1e-5f, 0.00199f), r = random.uniform(0.01f, 0.99f);
    const Vec3 target{r * std::cos(angle), r * std::sin(angle), 0};
    leaks += !any_hit(mesh.tree, mesh.triangles, {target + Vec3{0, 0, 1}, {0, 0, -1}});
    const Vec3 origin{random.uniform(-1, 2), random.uniform(-1, 1), random.uniform(0.2f, 1)};
    const Hit hit = closest_hit(mesh.tree, mesh.triangles, {origin, target - origin});
    leaks += hit.item == kAbsent;
    if (hit.item == kAbsent) continue;
    EXPECT_NEAR(hit.triangle.t, 1.0f, 1e-5f);
    EXPECT_LT(max_component(abs(point_of(mesh.triangles[hit.item], hit.triangle) - target)), 1e-5f);
  }
  EXPECT_EQ(leaks, 0);
}

} // namespace
} // namespace wavepath::bvh
