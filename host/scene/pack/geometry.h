// Triangles of an object in the order of its tree, and the vertex streams they refer to.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/pack.h"
#include "host/scene/usage.h"

namespace wavepath {

// A primitive on its way to the device. Meshes that are shown once carry their whole transform here ("baked"); shared
// meshes carry the identity, and their instances the transform.
struct Part {
  std::uint32_t mesh = 0;
  std::uint32_t primitive = 0;
  std::uint32_t surface = 0;      // kTriangle bits and an index into PackedScene::materials, see gpu::Triangle
  std::uint32_t first_vertex = 0; // of the mesh, in the vertex streams
  glm::dmat4 device_from_object{1.0};
  bool mirrored = false; // the transform mirrors: v1 and v2 change places, so that counter-clockwise stays the front
};

// A tree of triangles inside PackedScene::nodes and ::triangles.
struct Object {
  std::uint32_t first_item = 0, item_count = 0; // in PackedScene::triangles, copies included
  std::uint32_t triangle_count = 0;
  std::uint32_t root = 0;  // node of PackedScene::nodes
  std::uint32_t depth = 0; // nodes on the longest path from there
  double sah_cost = 0.0;   // see bvh::Measure
  glm::vec3 lo{0.0f}, hi{0.0f}; // around its boxes in the tree, in its own space; 0 if it is empty
};

// Appends the triangles of `parts` and the tree over them to `packed` (nodes, triangles, triangle_vertices if
// `with_vertices`). Triangles that are not finite or have exactly no area are left out and counted in
// packed.dropped_triangles, `times` each (the instances that would have shown them). light_pdf is left 0. Throws Error
// if there are more items or nodes than traversal can number.
Object append_object(const Scene& scene, std::span<const Part> parts, bool with_vertices, std::uint64_t times,
                     bvh::Quality quality, PackedScene& packed);

// Appends `tree` to `nodes`, its items renumbered from `first_item`; returns its root.
std::uint32_t append_tree(const bvh::WideTree& tree, std::uint32_t first_item, std::vector<bvh::WideNode>& nodes);

} // namespace wavepath
