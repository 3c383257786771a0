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

// Position and directions of a light: it emits within theta_e of a normal that is within theta_o of `axis`.
struct LightBounds {
  glm::vec3 lo{0.0f}, hi{0.0f};
  glm::vec3 axis{0.0f, 0.0f, 1.0f};     // unit length
  float theta_o = 0.0f, theta_e = 0.0f; // radians
  bool two_sided = false;               // emits the same to the other side
  double power = 0.0;                   // over all directions
  double intensity = 0.0;               // peak intensity, in the unit of what a receiver gets
};

// Bounds of a triangle of constant radiance that emits to the side from which it is counter-clockwise, or to both.
LightBounds triangle_light_bounds(const glm::vec3 (&corners)[3], double radiance, bool two_sided);
LightBounds point_light_bounds(const glm::vec3& position, double intensity);
// Bounds of a spot light. `outer_cone`: half angle beyond which there is no light. `power`: of all its light.
LightBounds spot_light_bounds(const glm::vec3& position, const glm::vec3& axis, double outer_cone, double intensity,
                              double power);

inline constexpr std::uint32_t kDeepestLightTree = 32; // because branches to a light are bits of a word

struct LightTree {
  struct Record {
    std::uint32_t words[8];
  };
  std::vector<Record> records;         // the root, then one node fewer than there are lights; 32 bytes for each light
  std::vector<std::uint32_t> branches; // for each light, the branches that lead to it: bit d at depth d
  std::vector<std::uint32_t> clusters; // for each light, its cluster of trained selection
  std::vector<std::uint32_t> cluster_branches; // the branches that lead to each cluster
  std::uint32_t depth = 0;                     // largest number of branches that lead to a light
};

// Builds the tree. `lights`: at least one, each with power > 0. The result does not depend on the number of threads.
LightTree build_light_tree(std::span<const LightBounds> lights);

// Bytes of light_tree_words(): 40 for each light, and 256.
std::uint64_t light_tree_bytes(std::uint64_t lights);

// The tree as kernels read it: the records; then branches and cluster, two lights in 16 bytes; then branches of
// clusters, four in 16 bytes.
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
