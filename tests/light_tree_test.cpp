// The light tree: every light in one leaf, bounds that hold what lies below, the same bytes for any number of threads.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "host/scene/pack/light_tree.h"
#include "tests/light_set.h"

namespace wavepath::test {
namespace {

// Calls `visit(light, trail, subtree)` at every leaf, and checks on the way down that boxes shrink.
void visit_leaves(const LightTree& tree, const gpu::LightCluster& at, std::uint32_t branches,
                  const std::function<void(std::uint32_t, std::uint32_t, const LightSubtree&)>& visit) {
  ASSERT_LT(at.depth, kDeepestLightTree);
  const gpu::LightTreeNode node = node_of(tree, at.link & gpu::kLightIndexMask);
  for (std::uint32_t k = 0; k < 2; ++k) {
    const LightSubtree next = subtree_of(at, node.child[k]);
    const std::uint32_t to = branches | k << at.depth;
    if (next.cluster.link & gpu::kLightLeaf)
      visit(next.cluster.link & gpu::kLightIndexMask, to, next);
    else
      visit_leaves(tree, next.cluster, to, visit);
  }
}

// From the axis of a subtree to that of a light below it. A two-sided subtree shines along its axis and against it.
double angle_to(const LightBounds& subtree, const LightBounds& light) {
  double cosine = glm::dot(glm::dvec3(subtree.axis), glm::dvec3(light.axis));
  if (subtree.two_sided) cosine = std::abs(cosine);
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

// Every light in exactly one leaf, its branches lead there, and all clusters on the way hold it.
void check(const std::vector<LightBounds>& lights) {
  const LightTree tree = build_light_tree(lights);
  ASSERT_EQ(tree.records.size(), lights.size()); // a root and n - 1 nodes of 32 bytes
  ASSERT_EQ(tree.branches.size(), lights.size());
  EXPECT_LE(tree.depth, kDeepestLightTree);
  const gpu::LightCluster root = root_of(tree);
  if (lights.size() == 1) {
    EXPECT_EQ(root.link, gpu::kLightLeaf | 0u);
    return;
  }
  std::vector<int> seen(lights.size(), 0);
  visit_leaves(tree, root, 0, [&](std::uint32_t light, std::uint32_t branches, const LightSubtree&) {
    ASSERT_LT(light, lights.size());
    ++seen[light];
    EXPECT_EQ(branches, tree.branches[light]);
  });
  for (const int times : seen) EXPECT_EQ(times, 1);

  double size = glm::length(root.hi - root.lo);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const LightBounds& light = lights[i];
    for (gpu::LightCluster at = root; !(at.link & gpu::kLightLeaf);) {
      const LightSubtree next =
          subtree_of(at, node_of(tree, at.link & gpu::kLightIndexMask).child[tree.branches[i] >> at.depth & 1u]);
      for (int axis = 0; axis < 3; ++axis) {
        const double slack = 1e-6 * (size + std::abs(light.lo[axis]) + std::abs(light.hi[axis]));
        ASSERT_LE(next.bounds.lo[axis], light.lo[axis] + slack) << i;
        ASSERT_GE(next.bounds.hi[axis], light.hi[axis] - slack) << i;
      }
      ASSERT_GE(next.bounds.theta_o + 1e-4, std::min(angle_to(next.bounds, light) + light.theta_o, std::numbers::pi));
      ASSERT_GE(next.bounds.theta_e + 1e-4, light.theta_e);
      if (light.two_sided) {
        ASSERT_TRUE(next.bounds.two_sided);
      }
      ASSERT_GT(next.bounds.intensity, 0.0);
      at = next.cluster;
    }
  }
}

TEST(LightTree, HoldsEveryLightInOneLeaf) {
  for (const std::size_t count : {1, 2, 3, 17, 1000, 20000})
    check(mixed_lights(count, 7 + static_cast<unsigned>(count)));
}

TEST(LightTree, StaysShallowForLightsThatDefyHalving) {
  std::vector<LightBounds> one_location(5000, point_light_bounds({1, 2, 3}, 4.0));
  check(one_location);
  std::vector<LightBounds> doubling; // each distance twice the one before: any cut between bins splits off one light
  for (int i = 0; i < 120; ++i)
    doubling.push_back(point_light_bounds({std::ldexp(1.0f, i - 60), 0, 0}, std::ldexp(1.0, -i)));
  check(doubling);
  std::vector<LightBounds> far_away = mixed_lights(300, 5);
  for (LightBounds& light : far_away) light.lo += 1e6f, light.hi += 1e6f;
  check(far_away);
}

TEST(LightTree, KeepsCloseWhatShinesAlike) {
  std::vector<LightBounds> lights; // two walls that face away from each other, 1 cm apart
  for (int i = 0; i < 64; ++i) {
    const float x = static_cast<float>(i % 8), y = static_cast<float>(i / 8), z = i % 2 == 0 ? 0.0f : 0.01f;
    glm::vec3 corners[3] = {{x, y, z}, {x + 0.5f, y, z}, {x, y + 0.5f, z}};
    if (i % 2 != 0) std::swap(corners[1], corners[2]);
    lights.push_back(triangle_light_bounds(corners, 1.0, false));
  }
  const LightTree tree = build_light_tree(lights);
  const gpu::LightCluster root = root_of(tree);
  for (const gpu::LightTreeChild& child : node_of(tree, root.link & gpu::kLightIndexMask).child)
    EXPECT_LT(subtree_of(root, child).bounds.theta_o, 0.1f) << "each half should hold one wall";
}

TEST(LightTree, IsTheSameForAnyNumberOfThreads) {
  const std::vector<LightBounds> lights = mixed_lights(30000, 3);
  const LightTree parallel = build_light_tree(lights);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const LightTree serial = build_light_tree(lights);
  EXPECT_EQ(parallel.branches, serial.branches);
  EXPECT_EQ(std::memcmp(parallel.records.data(), serial.records.data(), parallel.records.size() * 32), 0);
}

// A cut of the tree: each light belongs to the column that its trail passes, and to no other.
TEST(LightTree, DividesIntoClusters) {
  for (const std::size_t count : {1, 5, 61, 62, 4000}) {
    const std::vector<LightBounds> lights = mixed_lights(count, 31);
    const LightTree tree = build_light_tree(lights);
    EXPECT_EQ(tree.cluster_branches.size(), std::min<std::size_t>(count, gpu::kSubtreeClusters));
    ASSERT_EQ(tree.clusters.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      ASSERT_LT(tree.clusters[i], tree.cluster_branches.size());
      int passed = count == 1;
      gpu::LightCluster at = root_of(tree);
      while (!(at.link & gpu::kLightLeaf)) {
        const std::uint32_t choice = tree.branches[i] >> at.depth & 1u;
        at = subtree_of(at, node_of(tree, at.link & gpu::kLightIndexMask).child[choice]).cluster;
        if (!(at.link & gpu::kLightClusterRoot)) continue;
        ++passed;
        const std::uint32_t way = (1u << at.depth) - 1u;
        EXPECT_EQ(tree.cluster_branches[tree.clusters[i]], tree.branches[i] & way);
      }
      EXPECT_EQ(passed, 1);
    }
  }
}

TEST(LightTree, RoundsIntensitiesToAThousandth) {
  std::vector<LightBounds> lights;
  for (int i = 0; i < 80; ++i)
    lights.push_back(point_light_bounds({static_cast<float>(i), 0, 0}, std::exp2(-0.37 * i)));
  lights.push_back(point_light_bounds({90, 0, 0}, 1e-30)); // below what 16 bits hold, yet not dark
  double whole = 0.0;
  for (const LightBounds& light : lights) whole += light.intensity;
  const LightTree tree = build_light_tree(lights);
  visit_leaves(tree, root_of(tree), 0, [&](std::uint32_t i, std::uint32_t, const LightSubtree& leaf) {
    if (i == 80) {
      EXPECT_GT(leaf.bounds.intensity, 0.0);
      EXPECT_LT(leaf.bounds.intensity, 1e-18);
    } else {
      EXPECT_NEAR(leaf.bounds.intensity / (lights[i].intensity / whole), 1.0, 1e-3);
    }
  });
}

} // namespace
} // namespace wavepath::test
