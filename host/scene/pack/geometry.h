// Triangles of an object in the order of its tree, and the vertex streams they refer to.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/alpha.h"
#include "host/scene/pack/cut.h"
#include "host/scene/pack/kept_tree.h"
#include "host/scene/pack/packed_scene.h"
#include "host/scene/pack/part.h"
#include "host/scene/scene.h"
#include "host/scene/usage.h"

namespace wavepath {

// The cut of an object's parts, and the positions of its pieces among those of all objects.
struct PlacedCut {
  Cut cut;
  std::uint32_t first_piece = 0;
  // First vertex of the first piece of all objects; a piece has three vertices of its own.
  std::uint32_t first_vertex = 0;
};

// Triangles whose source ids are `first_id` or more, up to the next run, are of that part.
struct PartRun {
  std::uint32_t first_id = 0, part = 0;
};

// A tree of triangles inside PackedScene::nodes and ::triangles.
struct Object {
  std::uint32_t first_item = 0, item_count = 0; // range in PackedScene::triangles, copies included
  std::uint32_t triangle_count = 0;             // triangles, with pieces instead of cut triangles
  std::uint32_t source_count = 0;               // triangles before cutting
  std::uint32_t root = 0;                       // index in PackedScene::nodes
  std::uint32_t depth = 0;                      // nodes on the longest path from the root
  double sah_cost = 0.0;                        // see bvh::Measure
  glm::vec3 lo{0.0f}, hi{0.0f};                 // bounds of its boxes in the tree, in its own space; 0 if it is empty
  std::vector<PartRun> part_runs;               // ascending
};

// Appends the triangles of `parts` and the tree over them to `packed` (nodes, triangles, triangle_vertices if
// `with_vertices`, sources if `with_sources`). Triangles that are not finite or have exactly no area are left out and
// counted in packed.dropped_triangles, `times` each (the number of its instances). Those whose alpha lets no ray
// through lose kTriangleAlpha, and holes are left out; packed.alpha counts them once. `light` is left at kNone. Throws
// Error if there are more items or nodes than traversal can index. `cut`: of the parts. The first piece of a triangle
// takes its index and id, those of the others have gpu::kPieceId. With `with_vertices`, gpu::Triangle::id of the
// triangle that a piece was cut from is its fourth word in triangle_vertices. `trees`: of the last pose, whose object
// of the number `number` this is; null where none is kept.
Object append_object(const Scene& scene, std::span<const Part> parts, const PlacedCut& cut, const AlphaCoverage& alpha,
                     bool with_vertices, bool with_sources, std::uint64_t times, bvh::Quality quality, KeptTrees* trees,
                     std::size_t number, PackedScene& packed);

// Appends `tree` to `nodes`, its items renumbered from `first_item`; returns its root.
std::uint32_t append_tree(const bvh::WideTree& tree, std::uint32_t first_item, std::vector<bvh::WideNode>& nodes);

} // namespace wavepath
