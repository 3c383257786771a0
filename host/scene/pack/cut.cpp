// Finds huge triangles, and splits edges until pieces are small enough; see cut.h.
#include "host/scene/pack/cut.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <unordered_set>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include "host/scene/bounds.h"

namespace wavepath {
namespace {

// Edges are never split below this part of the longest one: an eye that lies in the plane of a triangle asks for any
// number of pieces, and single precision has none finer.
constexpr double kFinest = 0x1p-36;

// A vertex when the shutter opens and when it closes.
struct CutVertexPosition {
  glm::dvec3 open, close;
  bool operator==(const CutVertexPosition&) const = default;
};

bool comes_before(const glm::dvec3& a, const glm::dvec3& b) {
  return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
}

// Ends in an order that does not depend on the triangle.
struct CutEdge {
  CutVertexPosition a, b;
  bool operator==(const CutEdge&) const = default;
};

CutEdge make_cut_edge(const CutVertexPosition& a, const CutVertexPosition& b) {
  const bool ordered = a.open == b.open ? comes_before(a.close, b.close) : comes_before(a.open, b.open);
  return ordered ? CutEdge{a, b} : CutEdge{b, a};
}

struct HashCutEdge {
  std::size_t operator()(const CutEdge& edge) const {
    std::uint64_t hash = 0;
    for (const glm::dvec3& p : {edge.a.open, edge.b.open})
      for (int axis = 0; axis < 3; ++axis)
        hash = (hash ^ std::bit_cast<std::uint64_t>(p[axis] + 0.0)) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29;
    return hash;
  }
};

using CutEdges = std::unordered_set<CutEdge, HashCutEdge>;

struct CutTask {
  std::uint32_t part, first_index;
  auto operator<=>(const CutTask&) const = default;
};

struct CutWhole {
  CutVertexPosition corner[3];
};

CutWhole whole_triangle(const Scene& scene, std::span<const Part> parts, const CutTask& task) {
  const Part& part = parts[task.part];
  const Mesh& mesh = scene.meshes[part.mesh];
  CutWhole whole;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t v = mesh.indices[task.first_index + k];
    whole.corner[k].open = transform_point(part.device_from_object, mesh.positions[v]);
    whole.corner[k].close =
        mesh.moves() ? transform_point(part.device_from_object, mesh.end_positions[v]) : whole.corner[k].open;
  }
  return whole;
}

double distance_to_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double square = glm::dot(along, along);
  const double t = square > 0.0 ? std::clamp(glm::dot(p - a, along) / square, 0.0, 1.0) : 0.0;
  return glm::distance(p, a + t * along);
}

double distance_to_triangle(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double square = glm::dot(normal, normal);
  const auto inside = [&](const glm::dvec3& from, const glm::dvec3& to) {
    return glm::dot(glm::cross(to - from, p - from), normal) >= 0.0;
  };
  if (square > 0.0 && inside(a, b) && inside(b, c) && inside(c, a))
    return std::abs(glm::dot(p - a, normal)) / std::sqrt(square);
  return std::min({distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

double longest_edge(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
}

bool is_huge(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, std::span<const glm::dvec3> near) {
  const glm::dvec3 lo = glm::min(a, glm::min(b, c)), hi = glm::max(a, glm::max(b, c)), size = hi - lo;
  const double reach = glm::dot(size, size) / (kHugeRatio * kHugeRatio); // square of what the longest edge may span
  for (const glm::dvec3& p : near) {
    const glm::dvec3 aside = glm::max(glm::max(lo - p, p - hi), glm::dvec3(0.0));
    if (!(glm::dot(aside, aside) < reach)) continue; // NaN, too
    if (!finite_point(a) || !finite_point(b) || !finite_point(c)) return false;
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    if (normal == glm::dvec3(0.0)) return false;
    if (longest_edge(a, b, c) > kHugeRatio * distance_to_triangle(p, a, b, c)) return true;
  }
  return false;
}

// The positions as a part's mesh sees them, for a first look at its triangles as they are: most scenes need no other.
// `reach`: square of the longest edge over the distance from which on a triangle may be huge, under the transform.
struct CutSight {
  std::vector<glm::dvec3> near;
  double reach = 0.0;
};

CutSight sight_of(const Part& part, std::span<const glm::dvec3> near) {
  const glm::dmat4 object_from_device = glm::inverse(part.device_from_object);
  CutSight sight;
  for (const glm::dvec3& p : near) sight.near.push_back(transform_point(object_from_device, p));
  // Norms of Frobenius bound the largest stretch, and one over the smallest. A hundredth more is for rounding.
  const auto norm = [](const glm::dmat4& m) {
    return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
  };
  sight.reach = 1.01 * norm(part.device_from_object) * norm(object_from_device) / kHugeRatio;
  sight.reach *= sight.reach;
  return sight;
}

bool may_be_huge(const Mesh& mesh, const CutSight& sight, std::uint32_t first_index) {
  if (mesh.moves()) return true;
  const glm::vec3 &a = mesh.positions[mesh.indices[first_index]], &b = mesh.positions[mesh.indices[first_index + 1]],
                  &c = mesh.positions[mesh.indices[first_index + 2]];
  const glm::dvec3 lo = glm::min(a, glm::min(b, c)), hi = glm::max(a, glm::max(b, c)), size = hi - lo;
  const double reach = sight.reach * glm::dot(size, size);
  return std::ranges::any_of(sight.near, [&](const glm::dvec3& p) {
    const glm::dvec3 aside = glm::max(glm::max(lo - p, p - hi), glm::dvec3(0.0));
    return !(glm::dot(aside, aside) >= reach); // NaN, too
  });
}

template <typename Predicate>
std::vector<CutTask> find_triangles(const Scene& scene, std::span<const Part> parts, const Predicate& predicate) {
  const auto join = [](std::vector<CutTask> a, const std::vector<CutTask>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  };
  const auto add_part = [&](std::uint32_t p, std::vector<CutTask> found) {
    const Primitive& primitive = scene.meshes[parts[p].mesh].primitives[parts[p].primitive];
    const auto add = [&](const tbb::blocked_range<std::uint32_t>& range, std::vector<CutTask> some) {
      for (std::uint32_t t = range.begin(); t < range.end(); ++t) {
        const CutTask task{p, primitive.first_index + 3 * t};
        if (predicate(task)) some.push_back(task);
      }
      return some;
    };
    return join(std::move(found),
                tbb::parallel_reduce(tbb::blocked_range<std::uint32_t>(0, primitive.index_count / 3, 4096),
                                     std::vector<CutTask>{}, add, join));
  };
  const auto add_parts = [&](const tbb::blocked_range<std::uint32_t>& range, std::vector<CutTask> found) {
    for (std::uint32_t p = range.begin(); p < range.end(); ++p) found = add_part(p, std::move(found));
    return found;
  };
  return tbb::parallel_reduce(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(parts.size())),
                              std::vector<CutTask>{}, add_parts, join);
}

// Rule for splitting edges: those longer than `ratio` times their distance.
struct CutRule {
  std::span<const glm::dvec3> near;
  double ratio, shortest;

  bool splits(const glm::dvec3& a, const glm::dvec3& b) const {
    const double length = glm::distance(a, b);
    return length > shortest && std::ranges::any_of(near, [&](const glm::dvec3& p) {
             return length > ratio * distance_to_segment(p, a, b);
           });
  }
  bool splits(const CutEdge& edge) const {
    return splits(edge.a.open, edge.b.open) ||
           (!(edge.a.close == edge.a.open && edge.b.close == edge.b.open) && splits(edge.a.close, edge.b.close));
  }
};

struct CutCorner {
  CutVertexPosition position;
  glm::dvec3 weights;
};

CutCorner middle_of_edge(const CutCorner& a, const CutCorner& b) {
  return {{0.5 * (a.position.open + b.position.open), 0.5 * (a.position.close + b.position.close)},
          0.5 * (a.weights + b.weights)};
}

// `active`: by edge, opposite the corner of that number: whether the rule counts for it.
struct Cutting {
  CutCorner corner[3];
  bool active[3];
};

class TriangleCutter {
public:
  TriangleCutter(const CutRule& rule, bool huge, std::size_t most) : rule_(rule), huge_(huge), most_(most) {}

  // False if there are too many pieces.
  bool cut(const Cutting& whole, std::vector<Piece>& pieces) const {
    std::vector<Cutting> pending{whole};
    while (!pending.empty()) {
      const Cutting one = pending.back();
      pending.pop_back();
      if (pieces.size() + pending.size() >= most_) return false;
      if (split(one, pending)) continue;
      Piece& piece = pieces.emplace_back();
      for (int k = 0; k < 3; ++k) {
        piece.weights[k] = one.corner[k].weights;
        piece.position[k] = one.corner[k].position.open;
        piece.end[k] = one.corner[k].position.close;
      }
    }
    return true;
  }

private:
  bool marked(const Cutting& t, int k) const {
    return t.active[k] && rule_.splits(make_cut_edge(t.corner[(k + 1) % 3].position, t.corner[(k + 2) % 3].position));
  }

  // The edges that are marked, in halves; false if there is none. New edges within are the triangle's own.
  bool split(const Cutting& t, std::vector<Cutting>& out) const {
    const bool marks[3] = {marked(t, 0), marked(t, 1), marked(t, 2)};
    const int count = marks[0] + marks[1] + marks[2];
    if (count == 0) return false;
    if (count == 3) {
      const CutCorner m[3] = {middle_of_edge(t.corner[1], t.corner[2]), middle_of_edge(t.corner[2], t.corner[0]),
                              middle_of_edge(t.corner[0], t.corner[1])};
      out.push_back({{m[0], m[1], m[2]}, {huge_, huge_, huge_}});
      out.push_back({{m[1], m[0], t.corner[2]}, {t.active[0], t.active[1], huge_}});
      out.push_back({{m[2], t.corner[1], m[0]}, {t.active[0], huge_, t.active[2]}});
      out.push_back({{t.corner[0], m[2], m[1]}, {huge_, t.active[1], t.active[2]}});
      return true;
    }
    // Turned so that the one marked edge, or the one that is not, lies opposite corner 0.
    int first = 0;
    while (marks[first] != (count == 1)) ++first;
    const int i = first, j = (first + 1) % 3, k = (first + 2) % 3;
    const CutCorner &a = t.corner[i], &b = t.corner[j], &c = t.corner[k];
    if (count == 1) {
      const CutCorner m = middle_of_edge(b, c);
      out.push_back({{a, m, c}, {t.active[i], t.active[j], huge_}});
      out.push_back({{a, b, m}, {t.active[i], huge_, t.active[k]}});
      return true;
    }
    const CutCorner ab = middle_of_edge(a, b), ca = middle_of_edge(c, a);
    const bool from_b =
        glm::distance(b.position.open, ca.position.open) <= glm::distance(c.position.open, ab.position.open);
    if (from_b) {
      out.push_back({{b, c, ca}, {t.active[j], huge_, t.active[i]}});
      out.push_back({{ab, b, ca}, {huge_, huge_, t.active[k]}});
    } else {
      out.push_back({{ab, b, c}, {t.active[i], huge_, t.active[k]}});
      out.push_back({{ab, c, ca}, {t.active[j], huge_, huge_}});
    }
    out.push_back({{a, ab, ca}, {huge_, t.active[j], t.active[k]}});
    return true;
  }

  const CutRule& rule_;
  bool huge_;
  std::size_t most_;
};

} // namespace

Cut cut_huge(const Scene& scene, std::span<const Part> parts, std::span<const glm::dvec3> near) {
  if (near.empty()) return {};
  const auto whole = [&](const CutTask& task) { return whole_triangle(scene, parts, task); };
  std::vector<CutSight> sights;
  for (const Part& part : parts) sights.push_back(sight_of(part, near));
  const std::vector<CutTask> huge = find_triangles(scene, parts, [&](const CutTask& task) {
    if (!may_be_huge(scene.meshes[parts[task.part].mesh], sights[task.part], task.first_index)) return false;
    const CutWhole t = whole(task);
    const CutVertexPosition &a = t.corner[0], &b = t.corner[1], &c = t.corner[2];
    return is_huge(a.open, b.open, c.open, near) ||
           (scene.meshes[parts[task.part].mesh].moves() && is_huge(a.close, b.close, c.close, near));
  });
  if (huge.empty()) return {};

  double longest = 0.0;
  CutEdges edges;
  for (const CutTask& task : huge) {
    const CutWhole t = whole(task);
    longest = std::max(longest, longest_edge(t.corner[0].open, t.corner[1].open, t.corner[2].open));
    for (int k = 0; k < 3; ++k) edges.insert(make_cut_edge(t.corner[k], t.corner[(k + 1) % 3]));
  }
  const std::vector<CutTask> tasks = find_triangles(scene, parts, [&](const CutTask& task) {
    const CutWhole t = whole(task);
    for (int k = 0; k < 3; ++k)
      if (edges.contains(make_cut_edge(t.corner[k], t.corner[(k + 1) % 3])))
        return std::ranges::all_of(
            t.corner, [](const CutVertexPosition& v) { return finite_point(v.open) && finite_point(v.close); });
    return false;
  });

  for (double ratio = 1.0;; ratio *= 2.0) {
    const CutRule rule{near, ratio, longest * kFinest};
    std::vector<std::vector<Piece>> pieces(tasks.size());
    std::vector<std::uint8_t> fits(tasks.size());
    tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t i) {
      const CutWhole t = whole(tasks[i]);
      Cutting cutting;
      for (int k = 0; k < 3; ++k) {
        cutting.corner[k] = {t.corner[k], glm::dvec3(k == 0, k == 1, k == 2)};
        cutting.active[k] = edges.contains(make_cut_edge(t.corner[(k + 1) % 3], t.corner[(k + 2) % 3]));
      }
      fits[i] = TriangleCutter(rule, std::ranges::binary_search(huge, tasks[i]), kMostPieces).cut(cutting, pieces[i]);
    });
    std::size_t count = 0;
    for (const std::vector<Piece>& some : pieces) count += some.size();
    if (count > kMostPieces || std::ranges::find(fits, std::uint8_t{0}) != fits.end()) continue;
    Cut cut;
    cut.coarse = ratio > 1.0;
    cut.pieces.reserve(count);
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      if (pieces[i].size() < 2) continue;
      cut.triangles.push_back({tasks[i].part, tasks[i].first_index, static_cast<std::uint32_t>(cut.pieces.size()),
                               static_cast<std::uint32_t>(pieces[i].size())});
      cut.pieces.insert(cut.pieces.end(), pieces[i].begin(), pieces[i].end());
    }
    return cut;
  }
}

} // namespace wavepath
