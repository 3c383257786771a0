// Builds the light tree of kernels/light/light_tree.glsl: a binary tree over lights that have a location, by the
// surface area orientation heuristic (Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive
// Tree Splitting").
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "kernels/base/light_tree_types.h"

namespace wavepath {

// Where a light is and whereto it shines: within theta_e of a normal that is within theta_o of the axis.
struct LightBounds {
  glm::vec3 lo{0.0f}, hi{0.0f};
  glm::vec3 axis{0.0f, 0.0f, 1.0f};     // unit length
  float theta_o = 0.0f, theta_e = 0.0f; // radians
  bool two_sided = false;               // shines alike to the other side
  double power = 0.0;                   // over all directions
  double intensity = 0.0;               // peak, in proportion to what a receiver gets
};

// A triangle of constant radiance that shines to the side from which it is counter-clockwise, or to both.
LightBounds triangle_light_bounds(const glm::vec3 (&corners)[3], double radiance, bool two_sided);
LightBounds point_light_bounds(const glm::vec3& position, double intensity);
// `outer_cone`: angle from which on there is no light; `power`: of all light.
LightBounds spot_light_bounds(const glm::vec3& position, const glm::vec3& axis, double outer_cone, double intensity,
                              double power);

inline constexpr std::uint32_t kDeepestLightTree = 32; // branches to a light are bits of a word

struct LightTree {
  struct Record {
    std::uint32_t words[8];
  };
  std::vector<Record> records;                 // the root, then one node less than there are lights: 32 bytes a light
  std::vector<std::uint32_t> branches;         // by light the branches that lead to it, bit d the one at depth d
  std::vector<std::uint32_t> clusters;         // by light the cluster of trained selection that it belongs to
  std::vector<std::uint32_t> cluster_branches; // by cluster
  std::uint32_t depth = 0;                     // most choices that lead to a light
};

// At least one light, each with power. The result does not depend on the number of threads.
LightTree build_light_tree(std::span<const LightBounds> lights);

// Of light_tree_words(): 40 a light, and 256.
std::uint64_t light_tree_bytes(std::uint64_t lights);

// As kernels read it: the records; branches and cluster of two lights in every 16 bytes; branches of four clusters.
std::vector<glm::uvec4> light_tree_words(const LightTree& tree);

// ---- reading a tree, as the kernels do ------------------------------------------------------------------------------

gpu::LightCluster root_of(const LightTree& tree);
gpu::LightTreeNode node_of(const LightTree& tree, std::uint32_t record);

// A child of a node whose box is that of `parent`.
struct LightSubtree {
  gpu::LightCluster cluster;
  LightBounds bounds; // without power
};
LightSubtree subtree_of(const gpu::LightCluster& parent, const gpu::LightTreeChild& child);

} // namespace wavepath
