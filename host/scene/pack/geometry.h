// Triangles of an object in the order of its tree, and the vertex streams they refer to.
#pragma once

#include <cstdint>
#include <optional>
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

// Source of a triangle: its part, its first index in the mesh's index list, and its number among the object's pieces.
struct TriangleSource {
  std::uint32_t part, first_index;
  std::uint32_t piece = kNoIndex;
};

// What of an object goes over to a pose in which some of its parts are elsewhere.
struct KeptObject {
  std::vector<Part> parts;             // empty where nothing goes over: it moves or was cut
  std::vector<TriangleSource> sources; // by triangle, in the order of KeptTree::triangles; likewise:
  std::vector<Coverage> coverage;      // empty if alpha asks for nothing
  std::vector<std::uint32_t> ids;      // empty if they are the order
  // By part, and one more at the end: its first triangle. And whether none of its triangles was dropped.
  std::vector<std::uint32_t> first_triangles;
  std::vector<std::uint8_t> intact;
};

// A tree of triangles inside PackedScene::nodes and ::triangles.
struct Object {
  std::uint32_t first_item = 0, item_count = 0; // range in PackedScene::triangles, copies included
  std::uint32_t triangle_count = 0;             // triangles, with pieces instead of cut triangles
  std::uint32_t source_count = 0;               // triangles before cutting
  std::uint32_t root = 0, node_count = 0;       // first of its nodes in PackedScene::nodes
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
// of the number `number` this is; null where none is kept. `kept`: is filled for the next pose, unless it is null.
Object append_object(const Scene& scene, std::span<const Part> parts, const PlacedCut& cut, const AlphaCoverage& alpha,
                     bool with_vertices, bool with_sources, std::uint64_t times, bvh::Quality quality, KeptTrees* trees,
                     std::size_t number, KeptObject* kept, PackedScene& packed);

// The triangles of parts that are elsewhere, or nothing if one of them has no area now or had none: the object must be
// appended anew then. `parts`: those of `kept` where they are now.
std::optional<std::vector<MovedTriangles>> move_triangles(const Scene& scene, std::span<const Part> parts,
                                                          const KeptObject& kept, std::span<const std::uint32_t> moved);

// Writes the first object of packed.triangles again, from item `first` on. It has no pieces and does not move.
void write_items(const Scene& scene, const KeptObject& kept, const KeptTree& tree, std::uint32_t first,
                 PackedScene& packed);

// The same of all items, which lay in the order of `tree.former`. Triangles of parts that have not `moved` are copied.
void rearrange_items(const Scene& scene, const KeptObject& kept, const KeptTree& tree,
                     std::span<const std::uint32_t> moved, PackedScene& packed);

// Appends `tree` to `nodes`, its items renumbered from `first_item`; returns its root.
std::uint32_t append_tree(const bvh::WideTree& tree, std::uint32_t first_item, std::vector<bvh::WideNode>& nodes);

} // namespace wavepath
