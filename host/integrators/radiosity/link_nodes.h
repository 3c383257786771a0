// What hierarchical links join: the nodes of the trees that cut the triangles of a scene, each with two faces.
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
};

// By node of `tree.nodes`: parents come before their children.
std::vector<LinkNode> make_link_nodes(const PackedScene& scene, const PatchTree& tree);

// How nodes see each other if nothing stands between. A face is 2 * node + side, side 1 the back.
struct Exchange {
  double area = 0.0;                     // of either face times its form factor to the other; 0: they turn away
  double spread_a = 0.0, spread_b = 0.0; // how far form factors of points of a face are from their mean, over that mean
};
Exchange exchange_of(const std::vector<LinkNode>& nodes, std::uint32_t face_a, std::uint32_t face_b);

} // namespace wavepath
