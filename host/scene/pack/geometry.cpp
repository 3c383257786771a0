// Bakes, checks, orders and stores the triangles of one object; see geometry.h.
#include "host/scene/pack/geometry.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "bvh/build.h"
#include "bvh/measure.h"
#include "host/base/error.h"
#include "host/scene/bounds.h"
#include "host/scene/pack/bodies.h"

namespace wavepath {
namespace {

struct Corners {
  glm::vec3 position[3], end[3]; // when the shutter opens, and when it closes
  std::uint32_t vertex[3];       // in the vertex streams
  bool valid;                    // finite, with an area at either moment
};

bvh::Vec3 to_bvh(const glm::vec3& v) { return {v.x, v.y, v.z}; }

// Differences of floats are exact in double except at extreme ratios, so that the test finds exactly the degenerate
// triangles.
bool has_area(const glm::vec3 (&p)[3]) {
  const glm::dvec3 normal = glm::cross(glm::dvec3(p[1]) - glm::dvec3(p[0]), glm::dvec3(p[2]) - glm::dvec3(p[0]));
  return normal.x != 0.0 || normal.y != 0.0 || normal.z != 0.0;
}

// An object to be packed.
struct ObjectSource {
  const Scene& scene;
  std::span<const Part> parts;
  const PlacedCut& cut;
};

Corners find_corners(const ObjectSource& object, const TriangleSource& source) {
  const Part& part = object.parts[source.part];
  const Mesh& mesh = object.scene.meshes[part.mesh];
  Corners corners;
  corners.valid = true;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t slot = part.mirrored && k > 0 ? 3 - k : k;
    glm::dvec3 p, end;
    if (source.piece != kNoIndex) {
      const Piece& piece = object.cut.cut.pieces[source.piece];
      p = piece.position[k], end = piece.end[k];
      corners.vertex[slot] = object.cut.first_vertex + 3 * (object.cut.first_piece + source.piece) + k;
    } else {
      const std::uint32_t vertex = mesh.indices[source.first_index + k];
      p = end = transform_point(part.device_from_object, mesh.positions[vertex]);
      if (mesh.moves()) end = transform_point(part.device_from_object, mesh.end_positions[vertex]);
      corners.vertex[slot] = part.first_vertex + vertex;
    }
    corners.position[slot] = p;
    corners.end[slot] = end;
    corners.valid = corners.valid && finite_point(p) && finite_point(end);
  }
  corners.valid = corners.valid && (has_area(corners.position) || has_area(corners.end));
  return corners;
}

// Triangles in the order of the source, the first piece of one in its place; then the other pieces.
std::vector<TriangleSource> list_sources(const ObjectSource& object) {
  const Cut& cut = object.cut.cut;
  std::size_t count = cut.pieces.size() - cut.triangles.size();
  for (const Part& part : object.parts)
    count += object.scene.meshes[part.mesh].primitives[part.primitive].index_count / 3;
  std::vector<TriangleSource> sources;
  sources.reserve(count);
  auto next = cut.triangles.begin();
  for (std::uint32_t p = 0; p < object.parts.size(); ++p) {
    const Primitive& primitive = object.scene.meshes[object.parts[p].mesh].primitives[object.parts[p].primitive];
    for (std::uint32_t i = 0; i + 2 < primitive.index_count; i += 3) {
      TriangleSource& source = sources.emplace_back(TriangleSource{p, primitive.first_index + i, kNoIndex});
      if (next == cut.triangles.end() || next->part != p || next->first_index != source.first_index) continue;
      source.piece = next->first_piece;
      ++next;
    }
  }
  for (const CutTriangle& whole : cut.triangles)
    for (std::uint32_t k = 1; k < whole.piece_count; ++k)
      sources.push_back({whole.part, whole.first_index, whole.first_piece + k});
  return sources;
}

// Id of each triangle; for pieces, that of the triangle they were cut from.
struct Ids {
  std::vector<std::uint32_t> own, source;
};

// `sources`: the valid ones. The first of a triangle's pieces that is valid stands for it.
Ids number_pieces(const PlacedCut& cut, const std::vector<TriangleSource>& sources) {
  Ids ids;
  std::vector<std::uint32_t> triangle_of(cut.cut.pieces.size());
  for (const CutTriangle& whole : cut.cut.triangles)
    for (std::uint32_t k = 0; k < whole.piece_count; ++k) triangle_of[whole.first_piece + k] = whole.first_piece;
  std::vector<std::uint32_t> stands_for(cut.cut.pieces.size(), kNoIndex); // by triangle: an index of `sources`
  for (std::uint32_t i = 0; i < sources.size(); ++i) {
    if (sources[i].piece == kNoIndex) continue;
    std::uint32_t& first = stands_for[triangle_of[sources[i].piece]];
    first = std::min(first, i);
  }
  for (std::uint32_t i = 0; i < sources.size(); ++i) {
    const std::uint32_t piece = sources[i].piece, source = piece == kNoIndex ? i : stands_for[triangle_of[piece]];
    ids.own.push_back(source == i ? i : gpu::kPieceId | (cut.first_piece + piece));
    ids.source.push_back(source);
  }
  return ids;
}

// The valid triangles; the others are removed from `sources` as well.
std::vector<bvh::Triangle> list_valid(const ObjectSource& object, std::vector<TriangleSource>& sources) {
  std::vector<bvh::Triangle> triangles(sources.size());
  std::vector<std::uint8_t> valid(sources.size());
  tbb::parallel_for(std::size_t{0}, sources.size(), [&](std::size_t i) {
    const Corners c = find_corners(object, sources[i]);
    valid[i] = c.valid;
    triangles[i] = {to_bvh(c.position[0]), to_bvh(c.position[1]), to_bvh(c.position[2])};
  });
  std::size_t kept = static_cast<std::size_t>(std::ranges::find(valid, std::uint8_t{0}) - valid.begin());
  for (std::size_t i = kept; i < sources.size(); ++i) {
    if (!valid[i]) continue;
    sources[kept] = sources[i];
    triangles[kept++] = triangles[i];
  }
  sources.resize(kept);
  triangles.resize(kept);
  return triangles;
}

// Holes that shine stay, as lights are drawn from a list of all that do, and those of bodies, whose surfaces are
// counted.
bool may_leave_out(const Material& m) {
  const bool shines = !m.unlit && m.emission != glm::vec3(0.0f);
  return !shines && !is_body(m);
}

// Coverage of each triangle whose alpha traversal would have to look up. Empty if there is none.
std::vector<Coverage> list_coverage(const Scene& scene, std::span<const Part> parts,
                                    const std::vector<TriangleSource>& sources, const AlphaCoverage& alpha) {
  if (std::ranges::none_of(parts, [](const Part& part) { return (part.surface & gpu::kTriangleAlpha) != 0; }))
    return {};
  std::vector<Coverage> coverage(sources.size(), Coverage::none);
  tbb::parallel_for(std::size_t{0}, sources.size(), [&](std::size_t i) {
    const Part& part = parts[sources[i].part];
    if (!(part.surface & gpu::kTriangleAlpha)) return;
    const Mesh& mesh = scene.meshes[part.mesh];
    const Material& material = scene.materials[mesh.primitives[part.primitive].material];
    if (material.alpha_mode == AlphaMode::opaque) return; // unlit
    const Coverage found = alpha.of_triangle(mesh, material, sources[i].first_index);
    const bool asks = found == Coverage::hole ? !may_leave_out(material) : found == Coverage::opaque && material.unlit;
    coverage[i] = asks ? Coverage::mixed : found;
  });
  return coverage;
}

// Removes from all three what rays never meet. Returns by remaining triangle its id, its index among all: what hangs on
// ids does not change. Empty if nothing was removed.
std::vector<std::uint32_t> leave_out_holes(std::vector<Coverage>& coverage, std::vector<TriangleSource>& sources,
                                           std::vector<bvh::Triangle>& triangles) {
  if (std::ranges::find(coverage, Coverage::hole) == coverage.end()) return {};
  std::vector<std::uint32_t> ids;
  for (std::uint32_t i = 0; i < sources.size(); ++i) {
    if (coverage[i] == Coverage::hole) continue;
    const std::size_t kept = ids.size();
    coverage[kept] = coverage[i], sources[kept] = sources[i], triangles[kept] = triangles[i];
    ids.push_back(i);
  }
  coverage.resize(ids.size()), sources.resize(ids.size()), triangles.resize(ids.size());
  return ids;
}

AlphaCounts count_alpha(const std::vector<Coverage>& coverage) {
  const auto count = [&](Coverage kind) { return static_cast<std::uint64_t>(std::ranges::count(coverage, kind)); };
  return {count(Coverage::mixed), count(Coverage::opaque), count(Coverage::hole)};
}

bool moves(const Scene& scene, std::span<const Part> parts) {
  return std::ranges::any_of(parts, [&](const Part& part) { return scene.meshes[part.mesh].moves(); });
}

// Boxes that hold the triangles all the way, padded as bvh::bounds() pads those of triangles, and twice: the corner of
// a moment is rounded, too.
std::vector<bvh::Box> list_motion_boxes(const ObjectSource& object, std::span<const TriangleSource> sources) {
  std::vector<bvh::Box> boxes(sources.size());
  tbb::parallel_for(std::size_t{0}, sources.size(), [&](std::size_t i) {
    const Corners c = find_corners(object, sources[i]);
    bvh::Box box;
    for (int k = 0; k < 3; ++k) box = bvh::merge(bvh::merge(box, to_bvh(c.position[k])), to_bvh(c.end[k]));
    const float size = bvh::max_component(box.hi - box.lo) * 0x1p-19f;
    const bvh::Vec3 pad = bvh::max(bvh::abs(box.lo), bvh::abs(box.hi)) * 0x1p-21f + bvh::Vec3{size, size, size};
    boxes[i] = {box.lo - pad, box.hi + pad};
  });
  return boxes;
}

// Marks the triangles that the tree must hold only once: shadow rays lose the fraction of light that a BLEND surface or
// a pane stops each time that they meet it. Empty if there is none.
std::vector<std::uint8_t> list_whole(const Scene& scene, std::span<const Part> parts,
                                     const std::vector<TriangleSource>& sources) {
  const auto dims = [&](const Part& part) {
    const Primitive& primitive = scene.meshes[part.mesh].primitives[part.primitive];
    return scene.materials[primitive.material].alpha_mode == AlphaMode::blend ||
           (part.surface & gpu::kTrianglePane) != 0;
  };
  if (std::ranges::none_of(parts, dims)) return {};
  std::vector<std::uint8_t> whole;
  for (const TriangleSource& source : sources) whole.push_back(dims(parts[source.part]) ? 1 : 0);
  return whole;
}

// A leaf refers to its items by an index of limited width.
void require_items(const Scene& scene, std::size_t count) {
  if (count > bvh::kMaxItems)
    throw Error(scene.path, fmt::format("has more than {} triangles", bvh::kMaxItems),
                "simplify or split the scene, or try --bvh fast");
}

void set_box(const bvh::Box& box, Object& object) {
  object.lo = {box.lo.x, box.lo.y, box.lo.z};
  object.hi = {box.hi.x, box.hi.y, box.hi.z};
}

// What is known of the triangles of an object, by triangle; see KeptObject.
struct ObjectTables {
  ObjectSource object;
  std::span<const TriangleSource> sources;
  std::span<const Coverage> coverage;
  std::span<const std::uint32_t> ids;
  const Ids& ids_of_pieces;

  // The items of `tree` from `begin` on. `first`: where the object begins in the arrays of `packed`, which have room.
  void write(const bvh::WideTree& tree, std::size_t begin, std::size_t first, PackedScene& packed) const {
    write_some(tree, begin, first, packed, [](std::size_t, std::uint32_t) { return true; });
  }

  // Those for which asks(item, triangle) is true.
  template <class Asks>
  void write_some(const bvh::WideTree& tree, std::size_t begin, std::size_t first, PackedScene& packed,
                  const Asks& asks) const {
    tbb::parallel_for(begin, tree.order.size(), [&](std::size_t i) {
      const std::uint32_t t = tree.order[i];
      if (!asks(i, t)) return;
      const TriangleSource& source = sources[t];
      const Part& part = object.parts[source.part];
      const Corners c = find_corners(object, source);
      const std::uint32_t index = ids.empty() ? t : ids[t];
      const bool is_opaque = !coverage.empty() && coverage[t] == Coverage::opaque;
      const std::uint32_t surface = is_opaque ? part.surface & ~gpu::kTriangleAlpha : part.surface;
      const std::uint32_t id = ids_of_pieces.own.empty() ? index : ids_of_pieces.own[index];
      packed.triangles[first + i] = {c.position[0], surface, c.position[1], id, c.position[2], gpu::kNone};
      if (packed.motions.size() > first) // objects after the first stand still
        packed.motions[first + i] = {c.end[0] - c.position[0], 0u, c.end[1] - c.position[1], 0u,
                                     c.end[2] - c.position[2], 0u};
      if (!packed.sources.empty()) packed.sources[first + i] = {part.mesh, source.first_index};
      if (!packed.triangle_vertices.empty())
        packed.triangle_vertices[first + i] = {c.vertex[0], c.vertex[1], c.vertex[2],
                                               source.piece == kNoIndex ? 0u : ids_of_pieces.source[index]};
    });
  }
};

// By part, and one more at the end.
std::vector<std::uint32_t> list_first_triangles(std::size_t parts, std::span<const TriangleSource> sources) {
  std::vector<std::uint32_t> firsts(parts + 1, 0);
  for (const TriangleSource& source : sources) ++firsts[source.part + 1];
  for (std::size_t p = 0; p < parts; ++p) firsts[p + 1] += firsts[p];
  return firsts;
}

// By part: whether none of its triangles is missing in `sources`.
std::vector<std::uint8_t> list_intact(const Scene& scene, std::span<const Part> parts,
                                      std::span<const TriangleSource> sources) {
  const std::vector<std::uint32_t> firsts = list_first_triangles(parts.size(), sources);
  std::vector<std::uint8_t> intact;
  for (std::size_t p = 0; p < parts.size(); ++p)
    intact.push_back(firsts[p + 1] - firsts[p] ==
                     scene.meshes[parts[p].mesh].primitives[parts[p].primitive].index_count / 3);
  return intact;
}

} // namespace

std::uint32_t append_tree(const bvh::WideTree& tree, std::uint32_t first_item, std::vector<bvh::WideNode>& nodes) {
  const std::uint32_t first_node = static_cast<std::uint32_t>(nodes.size());
  nodes.insert(nodes.end(), tree.nodes.begin(), tree.nodes.end());
  for (std::size_t n = first_node; n < nodes.size(); ++n) {
    nodes[n].first_child += first_node;
    nodes[n].first_item += first_item;
  }
  return first_node;
}

Object append_object(const Scene& scene, std::span<const Part> parts, const PlacedCut& cut, const AlphaCoverage& alpha,
                     bool with_vertices, bool with_sources, std::uint64_t times, bvh::Quality quality, KeptTrees* trees,
                     std::size_t number, KeptObject* kept, PackedScene& packed) {
  const ObjectSource whole_object{scene, parts, cut};
  std::vector<TriangleSource> sources = list_sources(whole_object);
  // Pieces too thin for single precision are no fault of the source.
  const auto count_whole = [&] { return std::ranges::count(sources, kNoIndex, &TriangleSource::piece); };
  const auto listed = count_whole();
  std::vector<bvh::Triangle> triangles = list_valid(whole_object, sources);
  packed.dropped_triangles += static_cast<std::uint64_t>(listed - count_whole()) * times;
  std::vector<std::uint8_t> intact;
  if (kept && cut.cut.empty()) intact = list_intact(scene, parts, sources);
  const Ids ids_of_pieces = cut.cut.empty() ? Ids{} : number_pieces(cut, sources);
  std::vector<Coverage> coverage = list_coverage(scene, parts, sources, alpha);
  packed.alpha += count_alpha(coverage);
  std::vector<std::uint32_t> ids = leave_out_holes(coverage, sources, triangles);
  const bool moving = moves(scene, parts);
  const std::vector<bvh::Box> boxes = moving ? list_motion_boxes(whole_object, sources) : std::vector<bvh::Box>{};

  const std::size_t first = packed.triangles.size();
  require_items(scene, first + sources.size());
  Object object;
  object.first_item = static_cast<std::uint32_t>(first);
  object.triangle_count = static_cast<std::uint32_t>(sources.size());
  object.source_count =
      object.triangle_count - static_cast<std::uint32_t>(std::ranges::count_if(
                                  ids_of_pieces.own, [](std::uint32_t id) { return (id & gpu::kPieceId) != 0; }));
  const std::vector<std::uint8_t> whole = list_whole(scene, parts, sources);
  bvh::BuildReport report;
  bvh::WideTree own;
  if (moving)
    own = bvh::build(std::span<const bvh::Box>(boxes), {}, &report);
  else if (!trees)
    own = bvh::build(std::span<const bvh::Triangle>(triangles), {.quality = quality, .whole = whole}, &report);
  const KeptTree* again =
      trees && !moving ? &build_again(triangles, {.quality = quality, .whole = whole}, *trees, number) : nullptr;
  const bvh::WideTree& tree = again ? again->tree : own;
  if (!triangles.empty()) set_box(again ? again->box : report.box, object);
  triangles = {};
  require_items(scene, first + tree.order.size());
  if (packed.nodes.size() + tree.nodes.size() > bvh::kMaxNodes)
    throw Error(scene.path, fmt::format("needs more than {} BVH nodes", bvh::kMaxNodes), "simplify or split the scene");
  object.depth = tree.depth;
  object.sah_cost = again ? again->sah_cost : bvh::measure(tree).sah_cost;
  object.node_count = static_cast<std::uint32_t>(tree.nodes.size());
  object.root = append_tree(tree, object.first_item, packed.nodes);
  object.item_count = static_cast<std::uint32_t>(tree.order.size());

  for (std::uint32_t t = 0; t < sources.size(); ++t) {
    const std::uint32_t index = ids.empty() ? t : ids[t], part = sources[t].part;
    const std::uint32_t id = ids_of_pieces.source.empty() ? index : ids_of_pieces.source[index];
    if (id == index && (object.part_runs.empty() || object.part_runs.back().part != part))
      object.part_runs.push_back({id, part});
  }

  ObjectTables tables{whole_object, sources, coverage, ids, ids_of_pieces};
  packed.triangles.resize(first + tree.order.size());
  if (with_vertices) packed.triangle_vertices.resize(first + tree.order.size());
  if (with_sources) packed.sources.resize(first + tree.order.size());
  if (moving) packed.motions.resize(first + tree.order.size());
  tables.write(tree, 0, first, packed);
  if (kept) *kept = {};
  if (kept && !moving && cut.cut.empty()) {
    kept->parts.assign(parts.begin(), parts.end());
    kept->first_triangles = list_first_triangles(parts.size(), sources);
    kept->intact = std::move(intact);
    kept->sources = std::move(sources), kept->coverage = std::move(coverage), kept->ids = std::move(ids);
  }
  return object;
}

std::optional<std::vector<MovedTriangles>> move_triangles(const Scene& scene, std::span<const Part> parts,
                                                          const KeptObject& kept,
                                                          std::span<const std::uint32_t> moved) {
  const PlacedCut uncut;
  const ObjectSource object{scene, parts, uncut};
  std::vector<MovedTriangles> all(moved.size());
  std::vector<std::uint8_t> fits(moved.size());
  tbb::parallel_for(std::size_t{0}, moved.size(), [&](std::size_t i) {
    const std::uint32_t p = moved[i];
    const Primitive& primitive = scene.meshes[parts[p].mesh].primitives[parts[p].primitive];
    all[i].first = kept.first_triangles[p];
    std::uint32_t next = kept.first_triangles[p]; // those that were left out as holes must have an area, too
    for (std::uint32_t index = 0; index + 2 < primitive.index_count; index += 3) {
      const TriangleSource source{p, primitive.first_index + index};
      const Corners c = find_corners(object, source);
      if (!c.valid) return;
      if (next == kept.first_triangles[p + 1] || kept.sources[next].first_index != source.first_index) continue;
      all[i].triangles.push_back({to_bvh(c.position[0]), to_bvh(c.position[1]), to_bvh(c.position[2])});
      ++next;
    }
    fits[i] = kept.intact[p];
  });
  if (std::ranges::find(fits, std::uint8_t{0}) != fits.end()) return std::nullopt;
  return all;
}

void write_items(const Scene& scene, const KeptObject& kept, const KeptTree& tree, std::uint32_t first,
                 PackedScene& packed) {
  const PlacedCut uncut;
  const Ids no_pieces;
  const ObjectTables tables{{scene, kept.parts, uncut}, kept.sources, kept.coverage, kept.ids, no_pieces};
  tables.write(tree.tree, first, 0, packed);
}

void rearrange_items(const Scene& scene, const KeptObject& kept, const KeptTree& tree,
                     std::span<const std::uint32_t> moved, PackedScene& packed) {
  std::vector<std::uint8_t> has_moved(kept.parts.size(), 0);
  for (const std::uint32_t part : moved) has_moved[part] = 1;
  std::vector<std::uint32_t> places(kept.sources.size(), kNoIndex); // of one of its copies, by triangle
  for (std::uint32_t i = 0; i < tree.former.size(); ++i) places[tree.former[i]] = i;
  const std::size_t before = tree.former.size(), now = tree.tree.order.size();
  const auto resized = [&](const auto& values) { // with what lies behind the object
    std::remove_cvref_t<decltype(values)> others;
    if (values.empty()) return others;
    others.resize(values.size() - before + now);
    std::copy(values.begin() + static_cast<std::ptrdiff_t>(before), values.end(),
              others.begin() + static_cast<std::ptrdiff_t>(now));
    return others;
  };
  const std::vector<gpu::Triangle> triangles = std::exchange(packed.triangles, resized(packed.triangles));
  const std::vector<glm::uvec4> vertices = std::exchange(packed.triangle_vertices, resized(packed.triangle_vertices));
  const std::vector<SourceTriangle> sources = std::exchange(packed.sources, resized(packed.sources));
  const PlacedCut uncut;
  const Ids no_pieces;
  const ObjectTables tables{{scene, kept.parts, uncut}, kept.sources, kept.coverage, kept.ids, no_pieces};
  tables.write_some(tree.tree, 0, 0, packed, [&](std::size_t i, std::uint32_t t) {
    const std::uint32_t place = places[t];
    if (place == kNoIndex || has_moved[kept.sources[t].part]) return true;
    packed.triangles[i] = triangles[place];
    if (!sources.empty()) packed.sources[i] = sources[place];
    if (!vertices.empty()) packed.triangle_vertices[i] = vertices[place];
    return false;
  });
}

} // namespace wavepath
