// The reference traversal agrees with testing every triangle, and closed meshes do not leak.
#include <array>
#include <utility>

#include "bvh/traverse.h"

#include "tests/meshes.h"

namespace wavepath::bvh {
namespace {

Hit brute_force(const Mesh& mesh, const Ray& ray) {
  const PreparedRay prepared = prepare(ray);
  Hit hit;
  float t_best = ray.t_max;
  if (prepared.valid)
    test_leaf(prepared, mesh.triangles, mesh.tree.order, 0, static_cast<std::uint32_t>(mesh.triangles.size()), t_best,
              hit);
  return hit;
}

Vec3 point_of(const Triangle& t, const TriangleHit& hit) {
  return t.v0 * (1 - hit.b1 - hit.b2) + t.v1 * hit.b1 + t.v2 * hit.b2;
}

// Which copy of a triangle is found does not matter.
void expect_same(const Mesh& mesh, const Hit& a, const Hit& b) {
  ASSERT_EQ(a.item != kAbsent, b.item != kAbsent);
  if (a.item == kAbsent) return;
  ASSERT_EQ(mesh.tree.order[a.item], mesh.tree.order[b.item]);
  ASSERT_EQ(a.triangle.t, b.triangle.t);
}

using Tree = PerQuality;
using Watertight = PerQuality;
INSTANTIATE_TEST_SUITE_P(Qualities, Tree, ::testing::ValuesIn(kQualities), name_of);
INSTANTIATE_TEST_SUITE_P(Qualities, Watertight, ::testing::ValuesIn(kQualities), name_of);

// ---- tracing
// --------------------------------------------------------------------------------------------------------------

TEST_P(Tree, ClosestHitEqualsBruteForceOverScales) {
  for (int exponent = -6; exponent <= 6; exponent += 2) {
    const float scale = std::pow(10.0f, static_cast<float>(exponent));
    const Mesh mesh = build_checked(scaled(soup(1000, 20, 0.2f), scale), config());
    Random random(static_cast<unsigned>(exponent + 40));
    int hits = 0;
    for (int i = 0; i < 10'000; ++i) {
      Ray ray{random.point(-0.5f, 1.5f) * scale, random.direction()};
      if (i % 3 == 0) ray.t_max = random.uniform(0, 1) * scale;
      if (i % 5 == 0) ray.direction = ray.direction * random.uniform(1e-3f, 1e3f);
      const Hit expected = brute_force(mesh, ray);
      expect_same(mesh, closest_hit(mesh.tree, mesh.triangles, ray), expected);
      ASSERT_EQ(any_hit(mesh.tree, mesh.triangles, ray), expected.item != kAbsent);
      hits += expected.item != kAbsent;
    }
    EXPECT_GT(hits, 1000);
  }
}

// Triangles whose size is log-uniform over twelve decades, seen from as many distances.
TEST_P(Tree, ClosestHitEqualsBruteForceInMixedScales) {
  Random random(21);
  Triangles triangles;
  for (int i = 0; i < 1000; ++i) {
    const float at = std::pow(10.0f, random.uniform(-6, 6)), size = std::pow(10.0f, random.uniform(-6, 6));
    const Vec3 center = random.direction() * at;
    triangles.push_back({center, center + random.direction() * size, center + random.direction() * size});
  }
  const Mesh mesh = build_checked(triangles, config());
  for (int i = 0; i < 20'000; ++i) {
    const Triangle& aim = triangles[static_cast<std::size_t>(random.uniform() * 999)];
    const float b1 = random.uniform() / 2, b2 = random.uniform() / 2;
    const Vec3 target = aim.v0 + (aim.v1 - aim.v0) * b1 + (aim.v2 - aim.v0) * b2;
    const Vec3 origin = random.direction() * std::pow(10.0f, random.uniform(-6, 6));
    const Ray ray{origin, target - origin};
    expect_same(mesh, closest_hit(mesh.tree, mesh.triangles, ray), brute_force(mesh, ray));
  }
}

TEST_P(Tree, TiesGoToTheLowestTriangle) {
  Triangles triangles = soup(2000, 22);
  const std::size_t count = triangles.size();
  for (std::size_t copy = 0; copy < 3; ++copy)
    for (std::size_t i = 0; i < count; ++i) triangles.push_back(triangles[i]);
  const Mesh mesh = build_checked(triangles, config());
  Random random(23);
  for (int i = 0; i < 3000; ++i) {
    const Ray ray{random.point(-1, 2), random.direction()};
    expect_same(mesh, closest_hit(mesh.tree, mesh.triangles, ray), brute_force(mesh, ray));
  }
}

// Triangles of many sizes in one plane: the larger the box, the earlier it is entered, whatever the item.
TEST_P(Tree, TiesGoToTheLowestTriangleInAnyOrderOfVisits) {
  Random random(27);
  Triangles triangles;
  for (int i = 0; i < 1000; ++i) {
    const float x = random.uniform(-1, 1), y = random.uniform(-1, 1), size = random.uniform(0.1f, 3);
    triangles.push_back({{x - size, y - size, 0}, {x + size, y - size, 0}, {x, y + size, 0}});
  }
  const Mesh mesh = build_checked(triangles, config());
  for (int i = 0; i < 1000; ++i) {
    const Ray ray{{random.uniform(-1, 1), random.uniform(-1, 1), 1}, {random.uniform(-0.5f, 0.5f), 0, -1}};
    const Hit hit = closest_hit(mesh.tree, mesh.triangles, ray);
    ASSERT_EQ(hit.triangle.t, 1.0f);
    expect_same(mesh, hit, brute_force(mesh, ray));
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
  const auto hit = [&](float z, float t_max) {
    return any_hit(mesh.tree, mesh.triangles, {{0, 0, z}, {0, 0, 1}, t_max});
  };
  EXPECT_TRUE(hit(0, kInf));
  EXPECT_TRUE(hit(0, std::nextafter(1.0f, 2.0f)));
  EXPECT_FALSE(hit(0, 1.0f));
  EXPECT_FALSE(hit(1, kInf));
  EXPECT_TRUE(hit(std::nextafter(1.0f, 0.0f), kInf));
  EXPECT_FALSE(hit(2, kInf));
}

// Six times the signed volume of the tetrahedron over a triangle, and a bound on its error, in double.
std::pair<double, double> side_of(const Triangle& t, Vec3 p) {
  const auto minus = [](Vec3 a, Vec3 b) { return std::array{double{a.x} - b.x, double{a.y} - b.y, double{a.z} - b.z}; };
  const std::array a = minus(t.v0, p), b = minus(t.v1, p), c = minus(t.v2, p);
  double sum = 0, size = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    sum += a[i] * (b[j] * c[k] - b[k] * c[j]);
    size += std::fabs(a[i] * b[j] * c[k]) + std::fabs(a[i] * b[k] * c[j]);
  }
  return {sum, size * 1e-14};
}

// Origins within a few units in the last place of the triangle, whatever its shape: a hit is reported only if the
// triangle truly lies in front.
TEST(Trace, NothingBehindTheOriginIsHit) {
  Random random(28);
  int near_hits = 0;
  for (int i = 0; i < 300'000; ++i) {
    const Vec3 v0 = random.point(-1, 1), long_edge = random.point(-1, 1);
    const Vec3 v2 = v0 + long_edge * random.uniform() + random.point(-1, 1) * std::pow(10.0f, random.uniform(-4, 0));
    const Triangle t{v0, v0 + long_edge, v2};
    const float b1 = random.uniform(0.05f, 0.9f), b2 = random.uniform(0.05f, 0.95f - b1);
    const Vec3 on = t.v0 + (t.v1 - t.v0) * b1 + (t.v2 - t.v0) * b2;
    const Vec3 origin = on + random.point(-1, 1) * std::pow(10.0f, random.uniform(-8, -1));
    const Vec3 direction = random.direction();
    const auto [side, side_error] = side_of(t, origin);
    const auto [later, later_error] = side_of(t, origin + direction * 4.0f);
    if (std::fabs(side) < side_error || std::fabs(later) < later_error) continue;
    TriangleHit hit;
    const bool is_hit = intersect(prepare({origin, direction}), t, hit);
    const bool in_front = (side > 0) != (later > 0);
    if (is_hit) {
      ASSERT_TRUE(in_front) << "t = " << hit.t;
      near_hits += hit.t < 1e-5f;
    }
  }
  EXPECT_GT(near_hits, 1000);
}

// Rays that run exactly along the faces of boxes, with zeros of both signs.
TEST_P(Tree, AxisAlignedRaysOnBoxFaces) {
  Triangles triangles; // a 16 x 16 grid of quads in the plane z = 0
  for (int i = 0; i < 16; ++i)
    for (int j = 0; j < 16; ++j) {
      const float x = static_cast<float>(i), y = static_cast<float>(j);
      triangles.push_back({{x, y, 0}, {x + 1, y, 0}, {x + 1, y + 1, 0}});
      triangles.push_back({{x, y, 0}, {x + 1, y + 1, 0}, {x, y + 1, 0}});
    }
  const Mesh mesh = build_checked(triangles, config(1));
  for (const float zero : {0.0f, -0.0f})
    for (int i = -2; i <= 34; ++i)
      for (int j = -2; j <= 34; ++j) {
        const float x = static_cast<float>(i) / 2, y = static_cast<float>(j) / 2;
        const bool inside = i >= 0 && i <= 32 && j >= 0 && j <= 32;
        for (const float side : {-1.0f, 1.0f}) {
          const Ray ray{{x, y, 3 * side}, {zero, zero, -side}};
          const Hit hit = closest_hit(mesh.tree, mesh.triangles, ray);
          EXPECT_EQ(hit.item != kAbsent, inside);
          expect_same(mesh, hit, brute_force(mesh, ray));
        }
        const Ray along{{-5, y, 0}, {1, zero, zero}}; // within the plane: edge-on triangles are never hit
        EXPECT_EQ(closest_hit(mesh.tree, mesh.triangles, along).item, kAbsent);
      }
}

// Unwidened boxes, as a top-level tree may have: a ray within their faces enters one side or the other.
TEST(Trace, AxisAlignedRaysBetweenBoxes) {
  std::vector<Box> boxes;
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y) {
      const Vec3 lo{static_cast<float>(x), static_cast<float>(y), 0};
      boxes.push_back({lo, lo + Vec3{1, 1, 1}});
    }
  const WideTree tree = build(boxes, {.max_leaf_size = 1});
  for (const float zero : {0.0f, -0.0f})
    for (int x = 0; x < 8; ++x)
      for (int y = 0; y < 8; ++y) {
        const PreparedRay ray = prepare({{static_cast<float>(x), static_cast<float>(y), -1}, {zero, zero, 1}});
        for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(std::isfinite(ray.inverse[axis]) && ray.inverse[axis] > 0);
        int entered = 0;
        traverse(tree.nodes, 0, ray, Order::nearest_first, [&](std::uint32_t, std::uint32_t, float&) {
          ++entered;
          return false;
        });
        EXPECT_GE(entered, 1);
      }
}

// Whatever the triangle test accepts, the slab test must have let through, or brute force and tree disagree.
TEST(Trace, BoxesAreEnteredWhereTrianglesAreHit) {
  Random random(29);
  int hits = 0;
  for (int i = 0; i < 500'000; ++i) {
    const Vec3 thin{std::pow(10.0f, random.uniform(-6, 0)), std::pow(10.0f, random.uniform(-6, 0)), 1};
    const auto vertex = [&] {
      const Vec3 v = random.point(-1, 1);
      return Vec3{v.x * thin.x, v.y * thin.y, v.z * thin.z};
    };
    const Vec3 at = random.direction() * std::pow(10.0f, random.uniform(-6, 3));
    const Triangle t{at + vertex(), at + vertex(), at + vertex()};
    const Vec3 on_edge = t.v0 + (t.v1 - t.v0) * random.uniform();
    const Vec3 origin = on_edge + random.direction() * std::pow(10.0f, random.uniform(-6, 3));
    const PreparedRay ray = prepare({origin, on_edge - origin});
    TriangleHit hit;
    if (has_no_area(t) || !intersect(ray, t, hit)) continue;
    ++hits;
    const Box box = bounds(t), elsewhere{box.hi + Vec3{1, 1, 1}, box.hi + Vec3{2, 3, 4}};
    WideNode node = place_on_grid(std::vector{elsewhere, box});
    node.layout |= 2u << kInnerCountShift;
    EXPECT_NE(enter_children(node, ray, kInf).inner & 2u, 0u);
  }
  EXPECT_GT(hits, 50'000);
}

// ---- no leaks
// -------------------------------------------------------------------------------------------------------------

int count_leaks(const Mesh& mesh, Random& random, Vec3 center, float radius, int count) {
  int leaks = 0;
  const auto pick = [&]() -> const Triangle& {
    return mesh
        .triangles[static_cast<std::size_t>(random.uniform(0, 0.999f) * static_cast<float>(mesh.triangles.size()))];
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

TEST_P(Watertight, PerturbedSphere) {
  Random random(30);
  for (const std::uint32_t leaf_size : {1u, 4u})
    EXPECT_EQ(count_leaks(build_checked(sphere(100, 200, 0.02f), config(leaf_size)), random, {}, 0.9f, 50'000), 0);
}

TEST_P(Watertight, FarSphere) {
  Random random(31);
  const Vec3 center{148376, 1234, -223423};
  EXPECT_EQ(count_leaks(build_checked(sphere(50, 100, 0, center, 2), config()), random, center, 0.5f, 50'000), 0);
  EXPECT_EQ(count_leaks(build_checked(scaled(sphere(50, 100, 0.1f), 1e-6f), config()), random, {}, 0.5e-6f, 20'000), 0);
  EXPECT_EQ(count_leaks(build_checked(scaled(sphere(50, 100, 0.1f), 1e6f), config()), random, {}, 0.5e6f, 20'000), 0);
}

// A closed octahedron of eight large triangles, from points very near to an edge or a vertex, aimed at that edge.
TEST_P(Watertight, NearTheEdgeOfLargeTriangles) {
  const Triangles triangles = sphere(2, 4, 0.3f);
  ASSERT_EQ(triangles.size(), 8u);
  const Mesh mesh = build_checked(triangles, config(1));
  Random random(32);
  int leaks = 0;
  for (int i = 0; i < 300'000; ++i) {
    const Triangle& t = triangles[static_cast<std::size_t>(random.uniform(0, 7.99f))];
    const float along = random.uniform();
    const Vec3 on_edge = t.v0 + (t.v1 - t.v0) * along;
    const float distance = std::pow(10.0f, random.uniform(-4, -1));
    const Vec3 origin = on_edge * (1 - distance) + random.point(-1, 1) * (0.1f * distance);
    leaks += !any_hit(mesh.tree, mesh.triangles, {origin, on_edge - origin});
    const Vec3 nearby = t.v0 + (t.v1 - t.v0) * (along + random.uniform(-1e-3f, 1e-3f));
    leaks += !any_hit(mesh.tree, mesh.triangles, {origin, nearby - origin});
  }
  EXPECT_EQ(leaks, 0);
}

// A tetrahedron whose upper edge lies on the faces of its triangles' boxes, from points within 10^-4 of its size of
// that edge: neither may a box be missed, nor may the bound on the error of t be so loose that true hits are refused.
TEST_P(Watertight, NearAnEdgeThatBoundsItsBoxes) {
  const Vec3 r0{-1.1f, 3.37e-4f, 7.31e-4f}, r1{0.9f, 3.37e-4f, 7.31e-4f}, p{0.1f, -0.7f, -1.3f}, q{0.2f, 1.4f, -1.4f};
  const Mesh mesh = build_checked({{r0, r1, p}, {r0, r1, q}, {p, q, r0}, {p, q, r1}}, config(1));
  Random random(34);
  int leaks = 0;
  for (int i = 0; i < 300'000; ++i) {
    const Vec3 on_edge = r0 + (r1 - r0) * random.uniform(0.2f, 0.8f);
    const float distance = std::pow(10.0f, random.uniform(-4, -2));
    const Vec3 origin = on_edge + Vec3{random.uniform(-2, 2), random.uniform(-0.5f, 0.5f), -1} * distance;
    const Vec3 aside{0, random.uniform(-5e-8f, 5e-8f), random.uniform(-5e-8f, 5e-8f)};
    leaks += !any_hit(mesh.tree, mesh.triangles, {origin, on_edge - origin + aside});
  }
  EXPECT_EQ(leaks, 0);
}

// A disc of 10^6:1 slivers has no holes, seen from straight above or at a slant.
TEST_P(Watertight, FanOfSlivers) {
  constexpr int kCount = 2000;
  constexpr double kStep = 1e-6;
  const auto rim = [](int i) {
    return Vec3{static_cast<float>(std::cos(i * kStep)), static_cast<float>(std::sin(i * kStep)), 0.0f};
  };
  Triangles triangles;
  for (int i = 0; i < kCount; ++i) triangles.push_back({{0, 0, 0}, rim(i), rim(i + 1)});
  const Mesh mesh = build_checked(triangles, config());
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
