// Convex hulls of projected vertices, and the eye from which they fill a picture; see framing.h.
#include "host/scene/staging/framing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/scene/usage.h"

namespace wavepath {
namespace {

constexpr double kAzimuth = 0.5235987755982988, kElevation = 0.2268928027592629; // 30 and 13 degrees
// Where instances show more vertices than these, meshes that are shown several times count as their boxes.
constexpr std::uint64_t kMostVertices = std::uint64_t{1} << 24;

// Axes of the framing camera.
struct Axes {
  glm::dvec3 forward = framing_forward(), right = glm::normalize(glm::cross(forward, glm::dvec3(0.0, 1.0, 0.0))),
             up = glm::cross(right, forward);
};

double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Andrew's monotone chain, counter-clockwise.
std::vector<glm::dvec2> convex_hull(std::vector<glm::dvec2> points) {
  const auto before = [](const glm::dvec2& a, const glm::dvec2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<glm::dvec2> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t first = hull.size();
    for (const glm::dvec2& point : points) {
      while (hull.size() >= first + 2 && turn(hull[hull.size() - 2], hull.back(), point) <= 0.0) hull.pop_back();
      hull.push_back(point);
    }
    hull.pop_back(); // the other chain begins with it
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

// Points collected so far; reduced to their hull whenever there are many. Most points of a mesh lie well within what
// came before them, so that a few comparisons settle them: the hulls of ten million triangles then take a fifth of the
// time.
class Outline {
public:
  void add(const glm::dvec2& point) {
    if (well_inside(point)) return;
    if (points_.size() > 2 * reduced_ + 1024) reduce();
    points_.push_back(point);
  }
  void add(const Outline& other) { points_.insert(points_.end(), other.points_.begin(), other.points_.end()); }
  void reduce() {
    points_ = convex_hull(std::move(points_));
    reduced_ = points_.size();
    find_sides();
  }
  const std::vector<glm::dvec2>& points() const { return points_; }

private:
  static constexpr std::size_t kMostSides = 8;
  // Side of a polygon within the hull; inside is x * p.x + y * p.y > least.
  struct Side {
    double x, y, least;
  };

  bool well_inside(const glm::dvec2& p) const {
    if (side_count_ < 3) return false;
    for (std::size_t i = 0; i < side_count_; ++i)
      if (!(sides_[i].x * p.x + sides_[i].y * p.y > sides_[i].least)) return false;
    return true;
  }

  // The polygon of the hull's corners farthest in eight directions. Its sides are moved inwards by far more than
  // rounding, so that no point that the hull could need is taken for one inside.
  void find_sides() {
    std::vector<glm::dvec2> corners;
    double size = 0.0;
    for (const glm::dvec2& p : points_) size = std::max({size, std::abs(p.x), std::abs(p.y)});
    for (std::size_t i = 0; i < kMostSides && !points_.empty(); ++i) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(kMostSides);
      const glm::dvec2 direction(std::cos(angle), std::sin(angle));
      const glm::dvec2 corner = *std::ranges::max_element(
          points_, {}, [&](const glm::dvec2& p) { return p.x * direction.x + p.y * direction.y; });
      if (corners.empty() || (corner != corners.back() && corner != corners.front())) corners.push_back(corner);
    }
    side_count_ = corners.size();
    for (std::size_t i = 0; i < side_count_; ++i) {
      const glm::dvec2 &a = corners[i], &b = corners[(i + 1) % side_count_];
      const double x = a.y - b.y, y = b.x - a.x;
      sides_[i] = {x, y, x * a.x + y * a.y + 1e-9 * size * (std::abs(x) + std::abs(y))};
    }
  }

  std::vector<glm::dvec2> points_;
  std::size_t reduced_ = 0, side_count_ = 0;
  Side sides_[kMostSides]{};
};

struct Outlines {
  Outline across, upwards;

  void add(const Outlines& other) { across.add(other.across), upwards.add(other.upwards); }
};

void add_point(const Axes& axes, const glm::dvec3& p, Outlines& outlines) {
  const double depth = glm::dot(p, axes.forward);
  outlines.across.add({glm::dot(p, axes.right), depth});
  outlines.upwards.add({glm::dot(p, axes.up), depth});
}

// Outlines of a mesh. As in mesh_bounds(), only triangles that stay finite count.
Outlines mesh_outlines(const Mesh& mesh, const glm::dmat4& transform, const Axes& axes) {
  Outlines all;
  for (const Primitive& primitive : mesh.primitives) {
    const std::uint32_t* indices = mesh.indices.data() + primitive.first_index;
    const auto add_range = [&](const tbb::blocked_range<std::uint32_t>& range, Outlines outlines) {
      for (std::uint32_t t = range.begin(); t < range.end(); ++t) {
        glm::dvec3 p[3];
        for (int k = 0; k < 3; ++k) p[k] = transform_point(transform, mesh.positions[indices[3 * t + k]]);
        if (!finite_point(p[0]) || !finite_point(p[1]) || !finite_point(p[2])) continue;
        for (const glm::dvec3& point : p) add_point(axes, point, outlines);
      }
      outlines.across.reduce(), outlines.upwards.reduce();
      return outlines;
    };
    const auto join = [](Outlines a, const Outlines& b) { return a.add(b), a; };
    all.add(tbb::parallel_reduce(tbb::blocked_range<std::uint32_t>(0, primitive.index_count / 3, 4096), Outlines{},
                                 add_range, join));
  }
  return all;
}

void add_corners(const Axes& axes, const Bounds& box, const glm::dmat4& transform, Outlines& outlines) {
  for (int corner = 0; corner < 8; ++corner)
    add_point(axes,
              transform_point(transform, {corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                                          corner & 4 ? box.hi.z : box.lo.z}),
              outlines);
}

Outlines find_outlines(const Scene& scene, const Bounds& bounds) {
  const Axes axes;
  const Usage usage = find_usage(scene);
  const bool boxes = 3 * usage.triangles_seen > kMostVertices;
  const glm::dmat4 centred = glm::translate(glm::dmat4(1.0), -bounds.centre());
  Outlines all;
  for (const Instance& instance : scene.instances) {
    const std::uint32_t uses = usage.mesh_instances[instance.mesh];
    if (uses == 0) continue;
    const glm::dmat4 transform = centred * instance.world_from_object;
    if (boxes && uses > 1) {
      const Bounds box = transform_bounds(mesh_bounds(scene.meshes[instance.mesh], glm::dmat4(1.0)), transform);
      if (!box.empty() && finite_point(box.lo) && finite_point(box.hi)) add_corners(axes, box, glm::dmat4(1.0), all);
    } else {
      all.add(mesh_outlines(scene.meshes[instance.mesh], transform, axes));
    }
  }
  if (scene.volume) {
    const Volume& volume = *scene.volume;
    const VoxelGrid& density = volume.grids->density;
    const glm::dmat4 transform = centred * volume.world_from_grid * density.grid_from_index;
    add_corners(axes, index_bounds(density), transform, all);
  }
  all.across.reduce(), all.upwards.reduce();
  return all;
}

// The greatest depth at which an eye sees all of the outline within `slope` to either side of some axis.
double farthest_depth(const std::vector<glm::dvec2>& outline, double slope) {
  double right = -std::numeric_limits<double>::infinity(), left = right;
  for (const glm::dvec2& p : outline) {
    right = std::max(right, p.x - slope * p.y);
    left = std::max(left, -p.x - slope * p.y);
  }
  return -(right + left) / (2.0 * slope);
}

// The position beside the axis from which an eye at `depth` sees as much of the outline to its left as to its right.
double middle_seen(const std::vector<glm::dvec2>& outline, double depth) {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  for (const glm::dvec2& p : outline) lo = std::min(lo, p.x), hi = std::max(hi, p.x);
  for (int i = 0; i < 64; ++i) {
    const double middle = 0.5 * (lo + hi);
    double right = -std::numeric_limits<double>::infinity(), left = right;
    for (const glm::dvec2& p : outline) {
      right = std::max(right, (p.x - middle) / (p.y - depth));
      left = std::max(left, (middle - p.x) / (p.y - depth));
    }
    (right > left ? lo : hi) = middle;
  }
  return 0.5 * (lo + hi);
}

} // namespace

glm::dvec3 framing_forward() {
  return -glm::dvec3(std::sin(kAzimuth) * std::cos(kElevation), std::sin(kElevation),
                     std::cos(kAzimuth) * std::cos(kElevation));
}

Framing find_framing(const Scene& scene, bool look_inside) {
  Framing framing;
  framing.bounds = world_bounds(scene);
  if (framing.bounds.empty()) return framing;
  const Outlines outlines = find_outlines(scene, framing.bounds);
  framing.across = outlines.across.points(), framing.upwards = outlines.upwards.points();
  if (look_inside && !scene.instances.empty()) framing.inside = find_standpoint(scene, framing.bounds);
  return framing;
}

glm::dvec3 framing_eye(const Framing& framing, double half_width, double half_height) {
  const Axes axes;
  const double radius = framing.bounds.radius() > 0.0 ? framing.bounds.radius() : 1.0;
  if (framing.across.empty())
    return framing.bounds.centre() - axes.forward * (radius / (kFramedFraction * half_height));
  double depth = std::min(farthest_depth(framing.across, kFramedFraction * half_width),
                          farthest_depth(framing.upwards, kFramedFraction * half_height));
  for (const glm::dvec2& p : framing.across) depth = std::min(depth, p.y - 1e-2 * radius); // never at the surface
  return framing.bounds.centre() + axes.forward * depth + axes.right * middle_seen(framing.across, depth) +
         axes.up * middle_seen(framing.upwards, depth);
}

} // namespace wavepath
