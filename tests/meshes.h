// Triangle meshes for the tests of the BVH: random, closed, scaled; and a build that fails the test if the tree is not
// valid.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bvh/build.h"
#include "bvh/validate.h"

namespace wavepath::bvh {

inline constexpr float kInf = std::numeric_limits<float>::infinity();
inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

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

inline std::vector<Box> boxes_of(const Triangles& triangles) {
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
inline Mesh build_checked(const Triangles& triangles, const BuildConfig& config = {}) {
  Mesh mesh;
  mesh.tree = build(std::span<const Triangle>(triangles), config, &mesh.report);
  for (const std::string& reason : validate(mesh.tree, triangles)) ADD_FAILURE() << reason;
  for (std::uint32_t index : mesh.tree.order) mesh.triangles.push_back(triangles[index]);
  const std::size_t kept = triangles.size() - mesh.report.dropped, copies = mesh.tree.order.size() - kept;
  EXPECT_LE(static_cast<double>(copies), config.max_copies * static_cast<double>(kept));
  if (config.quality == Quality::fast) {
    EXPECT_EQ(copies, 0u);
    for (const std::string& reason : validate(mesh.tree, boxes_of(triangles))) ADD_FAILURE() << reason;
  }
  return mesh;
}

inline constexpr Quality kQualities[] = {Quality::fast, Quality::balanced, Quality::best};

class PerQuality : public ::testing::TestWithParam<Quality> {
protected:
  BuildConfig config() const { return {.quality = GetParam()}; }
  BuildConfig config(std::uint32_t max_leaf_size) const {
    return {.quality = GetParam(), .max_leaf_size = max_leaf_size};
  }
};

inline std::string name_of(const ::testing::TestParamInfo<Quality>& info) {
  constexpr const char* kNames[] = {"fast", "balanced", "best"};
  return kNames[static_cast<int>(info.param)];
}

inline Triangles soup(int count, unsigned seed, float size = 0.05f) {
  Random random(seed);
  Triangles triangles;
  for (int i = 0; i < count; ++i) {
    const Vec3 center = random.point();
    triangles.push_back({center, center + random.point(-size, size), center + random.point(-size, size)});
  }
  return triangles;
}

// Long thin triangles through the unit cube, and small ones between them.
inline Triangles straws(int count, unsigned seed) {
  Random random(seed);
  Triangles triangles = soup(4 * count, seed);
  for (int i = 0; i < count; ++i) {
    const Vec3 from = random.point(), to = random.point();
    triangles.push_back({from, to, to + random.direction() * 0.003f});
  }
  return triangles;
}

// Closed; the radius wobbles by `roughness`, the poles are single vertices.
inline Triangles sphere(int rings, int segments, float roughness, Vec3 center = {}, float radius = 1.0f) {
  Random random(7);
  std::vector<Vec3> vertices;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < segments; ++j) {
      const float theta = std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(rings);
      const float phi = 2 * std::numbers::pi_v<float> * static_cast<float>(j) / static_cast<float>(segments);
      const float r = radius * (1 + roughness * random.uniform(-1, 1));
      vertices.push_back(center +
                         Vec3{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)} * r);
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

inline Triangles scaled(Triangles triangles, float factor) {
  for (Triangle& t : triangles) t = {t.v0 * factor, t.v1 * factor, t.v2 * factor};
  return triangles;
}

} // namespace wavepath::bvh
