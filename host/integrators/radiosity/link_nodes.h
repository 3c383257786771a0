// Nodes that hierarchical links join: triangles, and the parts that trees of patches cut them into. Each has two faces.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "host/integrators/radiosity/patch_tree.h"

namespace wavepath {

struct LinkNode {
  gpu::Patch part;                   // of its triangle
  std::array<glm::dvec3, 3> corners; // in the device's world space
  glm::dvec3 normal{0.0};            // of the front
  double area = 0.0;                 // square metres, holes included
  std::uint32_t first_child = 0;     // of four; 0: a leaf
  std::uint32_t patch = 0;           // of a leaf
  bool is_root = true;               // a whole triangle
  bool has_back = true;              // rays meet it from behind
};

// Nodes of all trees, in the order of `tree.nodes`: parents come before their children. `culls_backs`: rays pass
// single-sided triangles from behind.
std::vector<LinkNode> make_link_nodes(const PackedScene& scene, const PatchTree& tree, bool culls_backs);

// Light that two faces exchange if nothing stands between. A face is 2 * node + side; side 1 is the back.
struct Exchange {
  double area = 0.0; // square metres: of either face, times its form factor to the other; 0: they turn away
  // How far form factors of points of a face are from their mean, over that mean.
  double spread_a = 0.0, spread_b = 0.0;
};
Exchange exchange_of(const std::vector<LinkNode>& nodes, std::uint32_t face_a, std::uint32_t face_b);

} // namespace wavepath
