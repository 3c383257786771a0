// Ray classification (Arvo and Kirk 1987): the space of rays, five coordinates and six faces of a cube of directions,
// cut into hypercubes. Each has the triangles that its beam of rays can meet, the nearest first.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "host/bench/structures/boxes.h"
#include "host/bench/structures/structure.h"

namespace wavepath {
namespace {

constexpr std::size_t kFewCandidates = 12; // of a hypercube that is left whole
// A hypercube that few rays visit is left whole too, because cutting it costs more than their tests; unless their lists
// would be long.
constexpr std::size_t kFewRays = 8, kManyCandidates = 512;
constexpr std::uint32_t kMostCuts = 62;
constexpr std::uint32_t kCutsOfAProgress = 20; // cuts that do not shorten a list by a tenth in all are given up
constexpr double kBeamSlack = 0x1p-18;         // of positions, relative to the largest coordinate: far above rounding
constexpr std::uint32_t kLeafMark = 7;

// Coordinates of rays: the origin in world space, then the direction across its largest component, over that.
struct Hypercube {
  std::array<float, 5> lo, hi;
};

// A triangle as the rays of one face see it: x and y across the face's axis, z along it, growing with the rays.
struct Candidate {
  std::uint32_t triangle;
  float depth; // the least z
  std::array<glm::vec3, 3> corners;
};

struct HalfSpace {
  glm::dvec3 normal;
  double offset; // outside: normal . p > offset
};

// All that the rays of a hypercube can reach: a convex hull without an end.
class Beam {
public:
  Beam(const Hypercube& cube, std::uint32_t face, double slack) : slack_(slack) {
    const std::uint32_t axis = face / 2;
    const bool backwards = face % 2 == 1;
    for (std::uint32_t i = 0; i < 2; ++i) {
      lo_[i] = cube.lo[(axis + 1 + i) % 3], hi_[i] = cube.hi[(axis + 1 + i) % 3];
      least_[i] = cube.lo[3 + i], most_[i] = cube.hi[3 + i];
    }
    lo_[2] = backwards ? -cube.hi[axis] : cube.lo[axis];
    hi_[2] = backwards ? -cube.lo[axis] : cube.hi[axis];
    add({0, 0, -1}, -lo_[2]);
    for (int i = 0; i < 2; ++i) {
      add_side(i, 1.0, hi_[i], most_[i]);
      add_side(i, -1.0, -lo_[i], -least_[i]);
    }
  }

  // True of every triangle that a ray of the beam meets, and of some others.
  bool may_meet(const Candidate& candidate) const {
    for (std::size_t i = 0; i < count_; ++i) {
      const HalfSpace& plane = planes_[i];
      const auto is_outside = [&](const glm::vec3& p) {
        return plane.normal.x * p.x + plane.normal.y * p.y + plane.normal.z * p.z > plane.offset;
      };
      if (is_outside(candidate.corners[0]) && is_outside(candidate.corners[1]) && is_outside(candidate.corners[2]))
        return false;
    }
    return !leaves_plane(candidate);
  }

private:
  void add(const glm::dvec3& normal, double offset) {
    planes_[count_++] = {normal, offset + slack_ * (std::fabs(normal.x) + std::fabs(normal.y) + std::fabs(normal.z))};
  }

  // The side on which sign * coordinate is at most `start` where rays begin, and grows by at most `slope` along z: from
  // the first origin where it grows, and where it falls from the last.
  void add_side(int coordinate, double sign, double start, double slope) {
    glm::dvec3 normal(0.0);
    normal[coordinate] = sign;
    if (slope < 0.0) add(normal, start);
    normal.z = -slope;
    add(normal, start - slope * (slope < 0.0 ? hi_[2] : lo_[2]));
  }

  // True if all rays begin on one side of the triangle's plane and stay there.
  bool leaves_plane(const Candidate& candidate) const {
    const glm::dvec3 a = candidate.corners[0];
    const glm::dvec3 normal = glm::cross(glm::dvec3(candidate.corners[1]) - a, glm::dvec3(candidate.corners[2]) - a);
    double least = 0.0, most = 0.0; // normal . (origin - a)
    for (int i = 0; i < 3; ++i) {
      const double from = normal[i] * (lo_[i] - a[i]), to = normal[i] * (hi_[i] - a[i]);
      least += std::min(from, to), most += std::max(from, to);
    }
    double slowest = normal.z, fastest = normal.z; // normal . direction
    for (int i = 0; i < 2; ++i) {
      slowest += std::min(normal[i] * least_[i], normal[i] * most_[i]);
      fastest += std::max(normal[i] * least_[i], normal[i] * most_[i]);
    }
    const double slack = slack_ * (std::fabs(normal.x) + std::fabs(normal.y) + std::fabs(normal.z));
    return (least > slack && slowest >= 0.0) || (most < -slack && fastest <= 0.0);
  }

  double slack_;
  std::array<double, 3> lo_{}, hi_{};      // of origins: x, y, z
  std::array<double, 2> least_{}, most_{}; // of directions: x and y for each z
  std::array<HalfSpace, 9> planes_{};
  std::size_t count_ = 0;
};

class Classifier {
public:
  Classifier(const StructureInput& input, Structure& tree) : rays_(input.rays), tree_(tree) {
    root_.lo.fill(std::numeric_limits<float>::max());
    root_.hi.fill(std::numeric_limits<float>::lowest());
    for (const StructureRay& ray : rays_)
      for (int axis = 0; axis < 3; ++axis) {
        root_.lo[axis] = std::min(root_.lo[axis], ray.origin[axis]);
        root_.hi[axis] = std::max(root_.hi[axis], ray.origin[axis]);
      }
    for (int axis = 0; axis < 3; ++axis) {
      if (rays_.empty()) root_.lo[axis] = tree.lo[axis], root_.hi[axis] = tree.lo[axis] + tree.size[axis];
      for (const float bound : {root_.lo[axis], root_.hi[axis], tree.lo[axis], tree.lo[axis] + tree.size[axis]})
        slack_ = std::max(slack_, kBeamSlack * std::fabs(double{bound}));
      reach_ = std::max(reach_, 0.5f * tree.size[axis]);
    }
    for (int i = 3; i < 5; ++i) root_.lo[i] = -1.0f, root_.hi[i] = 1.0f;
  }

  void build(const std::vector<Reference>& references, std::span<const bvh::Triangle> triangles) {
    tree_.nodes.resize(12);
    std::array<std::vector<std::uint32_t>, 6> rays;
    for (std::uint32_t i = 0; i < rays_.size(); ++i) rays[face_of(rays_[i].direction)].push_back(i);
    for (std::uint32_t face = 0; face < 6; ++face) {
      face_ = face;
      see(references, triangles);
      std::vector<std::uint32_t> all(seen_.size());
      std::iota(all.begin(), all.end(), 0u);
      if (rays[face].empty() && !rays_.empty()) all.clear(); // nobody asks
      place(face, root_, all, rays[face], 0, all.size());
    }
  }

private:
  // The axis is chosen as by make_traversal_ray() of kernels/bvh/triangle.glsl.
  static std::uint32_t face_of(const glm::vec3& direction) {
    const glm::vec3 size = glm::abs(direction);
    std::uint32_t axis = size.y > size.x ? 1 : 0;
    if (size.z > std::max(size.x, size.y)) axis = 2;
    return 2 * axis + (direction[static_cast<int>(axis)] < 0.0f ? 1 : 0);
  }

  void see(const std::vector<Reference>& references, std::span<const bvh::Triangle> triangles) {
    const int axis = static_cast<int>(face_ / 2);
    const float sign = face_ % 2 == 1 ? -1.0f : 1.0f;
    seen_.clear();
    for (const Reference& reference : references) {
      const auto turned = [&](const bvh::Vec3& v) {
        return glm::vec3(v[(axis + 1) % 3], v[(axis + 2) % 3], sign * v[axis]);
      };
      const bvh::Triangle& triangle = triangles[reference.triangle];
      Candidate& candidate = seen_.emplace_back(
          Candidate{reference.triangle, 0.0f, {turned(triangle.v0), turned(triangle.v1), turned(triangle.v2)}});
      const float least = std::min({candidate.corners[0].z, candidate.corners[1].z, candidate.corners[2].z});
      candidate.depth = least - static_cast<float>(slack_);
    }
    std::stable_sort(seen_.begin(), seen_.end(),
                     [](const Candidate& a, const Candidate& b) { return a.depth < b.depth; });
  }

  // Half of the rays' origin or direction on that coordinate; as the kernel decides it.
  bool is_below(const StructureRay& ray, std::uint32_t coordinate, float cut) const {
    if (coordinate < 3) return ray.origin[static_cast<int>(coordinate)] < cut;
    const int axis = static_cast<int>(face_ / 2), across = static_cast<int>((face_ / 2 + coordinate - 2) % 3);
    return ray.direction[across] < cut * std::fabs(ray.direction[axis]);
  }

  // The coordinate that widens the beam most, at a distance of half the scene.
  std::uint32_t widest(const Hypercube& cube) const {
    std::uint32_t best = 0;
    float most = -1.0f;
    for (std::uint32_t i = 0; i < 5; ++i) {
      const float side = cube.hi[i] - cube.lo[i];
      const float width = i >= 3 ? reach_ * side : i == face_ / 2 ? 0.5f * side : side;
      if (width > most) best = i, most = width;
    }
    return best;
  }

  // True if a cut is likely to save more tests than it costs.
  bool is_worth_cutting(std::size_t candidates, std::size_t rays, std::uint32_t cuts, std::size_t before) const {
    const bool in_vain = cuts > 0 && cuts % kCutsOfAProgress == 0 && 10 * candidates > 9 * before;
    return rays > 0 && cuts < kMostCuts && !in_vain &&
           (candidates > kManyCandidates || (candidates > kFewCandidates && rays >= kFewRays));
  }

  // `candidates`: indices of `seen_`, by growing depth. `before`: how many there were some cuts ago.
  void place(std::size_t node, const Hypercube& cube, const std::vector<std::uint32_t>& candidates,
             std::span<std::uint32_t> rays, std::uint32_t cuts, std::size_t before) {
    tree_.depth = std::max(tree_.depth, cuts);
    const std::uint32_t coordinate = widest(cube);
    const float cut = 0.5f * (cube.lo[coordinate] + cube.hi[coordinate]);
    const bool has_halves = cut > cube.lo[coordinate] && cut < cube.hi[coordinate];
    if (!has_halves || !is_worth_cutting(candidates.size(), rays.size(), cuts, before)) return end(node, candidates);
    const std::size_t first = tree_.nodes.size() / 2;
    tree_.nodes.resize(tree_.nodes.size() + 4);
    tree_.nodes[2 * node] = std::bit_cast<std::uint32_t>(cut);
    tree_.nodes[2 * node + 1] = static_cast<std::uint32_t>(first << 3 | coordinate);
    const auto middle = std::partition(rays.begin(), rays.end(),
                                       [&](std::uint32_t ray) { return is_below(rays_[ray], coordinate, cut); });
    const auto below = static_cast<std::size_t>(middle - rays.begin());
    const std::size_t from_now = cuts % kCutsOfAProgress == 0 ? candidates.size() : before;
    for (std::size_t half = 0; half < 2; ++half) {
      Hypercube part = cube;
      (half == 0 ? part.hi : part.lo)[coordinate] = cut;
      const std::span<std::uint32_t> its = half == 0 ? rays.first(below) : rays.subspan(below);
      if (its.empty()) {
        end(first + half, {});
      } else {
        place(first + half, part, kept(part, candidates), its, cuts + 1, from_now);
      }
    }
  }

  void end(std::size_t node, const std::vector<std::uint32_t>& candidates) {
    tree_.nodes[2 * node] = static_cast<std::uint32_t>(tree_.items.size());
    tree_.nodes[2 * node + 1] = static_cast<std::uint32_t>(candidates.size()) << 3 | kLeafMark;
    for (const std::uint32_t candidate : candidates) {
      tree_.items.push_back(seen_[candidate].triangle);
      tree_.item_depths.push_back(seen_[candidate].depth);
    }
  }

  std::vector<std::uint32_t> kept(const Hypercube& cube, const std::vector<std::uint32_t>& candidates) const {
    const Beam beam(cube, face_, slack_);
    std::vector<std::uint32_t> result;
    for (const std::uint32_t candidate : candidates)
      if (beam.may_meet(seen_[candidate])) result.push_back(candidate);
    return result;
  }

  std::span<const StructureRay> rays_;
  Structure& tree_;
  Hypercube root_;
  float reach_ = 0.0f; // half of the scene's longest side
  double slack_ = 0.0;
  std::uint32_t face_ = 0;
  std::vector<Candidate> seen_; // by the rays of this face, by growing depth
};

} // namespace

Structure build_ray_classification(const StructureInput& input) {
  bvh::Box box;
  const std::vector<Reference> references = refer_to(input.triangles, box);
  Structure tree;
  tree.lo = {box.lo.x, box.lo.y, box.lo.z};
  tree.size = glm::vec3(box.hi.x, box.hi.y, box.hi.z) - tree.lo;
  Classifier(input, tree).build(references, input.triangles);
  return tree;
}

} // namespace wavepath
