// A light buffer (Haines and Greenberg 1986): a cube of directions about a lamp, each cell of which lists the triangles
// that a ray to the lamp can meet there, the nearest to the lamp first.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "host/bench/structures/boxes.h"
#include "host/bench/structures/structure.h"

namespace wavepath {
namespace {

constexpr double kCellsOfATriangle = 4.0; // over all six faces
constexpr double kLeastSide = 16.0, kMostSide = 256.0;
// Slack of positions, relative to the largest coordinate, and of projected ones: far more than rounding moves anything.
constexpr double kPositionSlack = 0x1p-18, kProjectedSlack = 0x1p-16;

// Corner of a triangle as a face of the cube sees it: across the face, and the distance along its axis.
struct Corner {
  double x, y, depth;
};
using Polygon = std::vector<Corner>;

// Corner projected to the face, which is [-1,1] x [-1,1]. On a plane the inverse of the depth is linear in x and y.
struct Projected {
  double x, y, inverse_depth;
};

struct Rectangle {
  double x, y, half; // its middle, and half its sides
};

struct Entry {
  std::uint32_t triangle;
  float depth; // least distance to the lamp along the axis of the face
};

struct Cell {
  std::vector<Entry> entries;
  double closed_from = std::numeric_limits<double>::infinity(); // depth from which on a triangle stands before all
};

// The part on the inner side of the plane at which `inside`, linear in a corner, is 0 (Sutherland and Hodgman 1974).
template <class Inside>
Polygon cut(const Polygon& polygon, const Inside& inside) {
  Polygon part;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double of_a = inside(a), of_b = inside(b);
    if (of_a >= 0.0) part.push_back(a);
    if ((of_a >= 0.0) == (of_b >= 0.0)) continue;
    const double f = of_a / (of_a - of_b);
    part.push_back({a.x + f * (b.x - a.x), a.y + f * (b.y - a.y), a.depth + f * (b.depth - a.depth)});
  }
  return part;
}

// The triangle's part within the pyramid that the lamp sees through a face, not nearer than `nearest`.
Polygon cut_to_face(const Polygon& triangle, double nearest) {
  constexpr double kWide = 1.0 + 4 * kProjectedSlack;
  Polygon part = cut(triangle, [&](const Corner& c) { return c.depth - nearest; });
  part = cut(part, [](const Corner& c) { return kWide * c.depth - c.x; });
  part = cut(part, [](const Corner& c) { return kWide * c.depth + c.x; });
  part = cut(part, [](const Corner& c) { return kWide * c.depth - c.y; });
  return cut(part, [](const Corner& c) { return kWide * c.depth + c.y; });
}

// The projection of a triangle's part: a convex polygon, and what the plane's depth is at its places.
class Shadow {
public:
  Shadow(const Polygon& part, double position_slack) {
    for (const Corner& c : part) corners_.push_back({c.x / c.depth, c.y / c.depth, 1.0 / c.depth});
    for (const Projected& p : corners_) {
      least_inverse_ = std::min(least_inverse_, p.inverse_depth);
      most_inverse_ = std::max(most_inverse_, p.inverse_depth);
    }
    margin_ = kProjectedSlack + position_slack * most_inverse_;
    double area = 0.0;
    for (std::size_t i = 0; i < corners_.size(); ++i) area += turn(corners_[0], corners_[i], next(i));
    if (area < 0.0) std::reverse(corners_.begin(), corners_.end());
    fit_plane();
  }

  double margin() const { return margin_; }

  std::array<double, 4> bounds() const { // x from, to, y from, to
    std::array<double, 4> box = {1e30, -1e30, 1e30, -1e30};
    for (const Projected& p : corners_)
      box = {std::min(box[0], p.x), std::max(box[1], p.x), std::min(box[2], p.y), std::max(box[3], p.y)};
    return {box[0] - margin_, box[1] + margin_, box[2] - margin_, box[3] + margin_};
  }

  // False if the polygon does not meet the rectangle. `covers` receives true if it fills the rectangle.
  bool meets(const Rectangle& cell, bool& covers) const {
    covers = true;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Projected &a = corners_[i], &b = next(i);
      const double ex = b.x - a.x, ey = b.y - a.y, length = std::fabs(ex) + std::fabs(ey);
      const double middle = ex * (cell.y - a.y) - ey * (cell.x - a.x), reach = cell.half * length;
      if (middle + reach < -margin_ * length) return false;
      covers = covers && middle - reach > margin_ * length;
    }
    return true;
  }

  double nearest(const Rectangle& cell) const { return 1.0 / std::min(inverse_depth(cell, 1.0), most_inverse_); }
  double farthest(const Rectangle& cell) const { return 1.0 / std::max(inverse_depth(cell, -1.0), least_inverse_); }
  double nearest() const { return 1.0 / most_inverse_; }

private:
  const Projected& next(std::size_t i) const { return corners_[(i + 1) % corners_.size()]; }

  static double turn(const Projected& a, const Projected& b, const Projected& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  }

  // The plane goes through the three corners that span the largest area. A polygon without an area has none; its bounds
  // then stand for those in a cell.
  void fit_plane() {
    double most = 0.0;
    for (std::size_t i = 1; i + 1 < corners_.size(); ++i) {
      const Projected &a = corners_[0], &b = corners_[i], &c = corners_[i + 1];
      const double area = turn(a, b, c);
      if (area <= most) continue;
      most = area;
      const double of_b = b.inverse_depth - a.inverse_depth, of_c = c.inverse_depth - a.inverse_depth;
      slope_x_ = (of_b * (c.y - a.y) - of_c * (b.y - a.y)) / area;
      slope_y_ = (of_c * (b.x - a.x) - of_b * (c.x - a.x)) / area;
      offset_ = a.inverse_depth - slope_x_ * a.x - slope_y_ * a.y;
    }
    flat_ = most > 1e-9; // else rounding would tell the slopes
  }

  // The most (`sign` 1) or the least (-1) in the cell.
  double inverse_depth(const Rectangle& cell, double sign) const {
    if (!flat_) return sign > 0.0 ? most_inverse_ : least_inverse_;
    const double reach = (cell.half + margin_) * (std::fabs(slope_x_) + std::fabs(slope_y_));
    return offset_ + slope_x_ * cell.x + slope_y_ * cell.y + sign * reach;
  }

  std::vector<Projected> corners_;
  double least_inverse_ = std::numeric_limits<double>::infinity(), most_inverse_ = 0.0;
  double margin_ = 0.0, slope_x_ = 0.0, slope_y_ = 0.0, offset_ = 0.0;
  bool flat_ = false;
};

class LightBufferBuilder {
public:
  LightBufferBuilder(const bvh::Box& box, const glm::vec3& lamp, std::uint32_t side)
      : lamp_(lamp), side_(side), cells_(std::size_t{6} * side * side) {
    const bvh::Vec3 most = bvh::max(bvh::abs(box.lo), bvh::abs(box.hi));
    slack_ = kPositionSlack * std::max({double{most.x}, double{most.y}, double{most.z}, std::fabs(double{lamp.x}),
                                        std::fabs(double{lamp.y}), std::fabs(double{lamp.z})});
  }

  void add(std::uint32_t index, const bvh::Triangle& triangle) {
    for (std::uint32_t face = 0; face < 6; ++face) add_to_face(index, triangle, face);
  }

  void finish(Structure& buffer) {
    for (int axis = 0; axis < 3; ++axis)
      buffer.nodes.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(lamp_[axis])));
    for (Cell& cell : cells_) {
      buffer.nodes.push_back(static_cast<std::uint32_t>(buffer.items.size()));
      std::sort(cell.entries.begin(), cell.entries.end(), [](const Entry& a, const Entry& b) {
        return a.depth != b.depth ? a.depth < b.depth : a.triangle < b.triangle;
      });
      for (const Entry& entry : cell.entries) {
        if (entry.depth > cell.closed_from) break; // behind a triangle that no ray of the cell passes
        buffer.items.push_back(entry.triangle);
        buffer.item_depths.push_back(entry.depth);
      }
    }
    buffer.nodes.push_back(static_cast<std::uint32_t>(buffer.items.size()));
  }

private:
  void add_to_face(std::uint32_t index, const bvh::Triangle& triangle, std::uint32_t face) {
    const int axis = static_cast<int>(face / 2);
    const double sign = face % 2 == 0 ? 1.0 : -1.0;
    const auto corner = [&](const bvh::Vec3& v) {
      const auto along = [&](int i) { return double{v[i]} - lamp_[i]; };
      return Corner{along((axis + 1) % 3), along((axis + 2) % 3), sign * along(axis)};
    };
    const Polygon whole = {corner(triangle.v0), corner(triangle.v1), corner(triangle.v2)};
    // Nearer than that every direction may lead to it: in all cells of the face.
    const double near = 4 * slack_;
    if (reaches(whole, near)) return add_everywhere(index, face);
    const Polygon part = cut_to_face(whole, near);
    if (part.size() < 3) return;
    const Shadow shadow(part, slack_);
    const auto [x_from, x_to, y_from, y_to] = shadow.bounds();
    const auto cell_of = [&](double place) {
      return static_cast<std::uint32_t>(std::clamp(std::floor(0.5 * (place + 1.0) * side_), 0.0, side_ - 1.0));
    };
    const double half = 1.0 / side_;
    for (std::uint32_t y = cell_of(y_from); y <= cell_of(y_to); ++y)
      for (std::uint32_t x = cell_of(x_from); x <= cell_of(x_to); ++x) {
        const Rectangle place = {(2.0 * x + 1.0) / side_ - 1.0, (2.0 * y + 1.0) / side_ - 1.0, half};
        bool covers = false;
        if (!shadow.meets(place, covers)) continue;
        Cell& cell = cells_[(std::size_t{face} * side_ + y) * side_ + x];
        cell.entries.push_back({index, lowered(shadow.nearest(place))});
        // A triangle that the lamp stands on closes no cell: rays end before they meet it.
        if (covers && shadow.nearest() > 64 * slack_)
          cell.closed_from = std::min(cell.closed_from, shadow.farthest(place) * (1.0 + kProjectedSlack) + slack_);
      }
  }

  // False if the triangle's box, or its plane, is farther from the lamp than `distance`.
  static bool reaches(const Polygon& triangle, double distance) {
    const auto spans = [&](auto coordinate) {
      double lo = 1e30, hi = -1e30;
      for (const Corner& c : triangle) lo = std::min(lo, coordinate(c)), hi = std::max(hi, coordinate(c));
      return lo <= distance && hi >= -distance;
    };
    if (!spans([](const Corner& c) { return c.x; }) || !spans([](const Corner& c) { return c.y; }) ||
        !spans([](const Corner& c) { return c.depth; }))
      return false;
    const glm::dvec3 a(triangle[0].x, triangle[0].y, triangle[0].depth),
        b(triangle[1].x, triangle[1].y, triangle[1].depth), c(triangle[2].x, triangle[2].y, triangle[2].depth);
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    return std::fabs(glm::dot(normal, a)) <= distance * 2.0 * glm::length(normal);
  }

  void add_everywhere(std::uint32_t index, std::uint32_t face) {
    for (std::uint32_t i = 0; i < side_ * side_; ++i)
      cells_[std::size_t{face} * side_ * side_ + i].entries.push_back({index, -std::numeric_limits<float>::infinity()});
  }

  float lowered(double depth) const { return static_cast<float>(depth * (1.0 - kProjectedSlack) - slack_); }

  glm::dvec3 lamp_;
  std::uint32_t side_;
  double slack_ = 0.0;
  std::vector<Cell> cells_; // face by face, row by row
};

} // namespace

Structure build_light_buffer(const StructureInput& input) {
  bvh::Box box;
  const std::vector<Reference> references = refer_to(input.triangles, box);
  Structure buffer;
  buffer.words_per_node = 1;
  buffer.lo = {box.lo.x, box.lo.y, box.lo.z};
  buffer.size = glm::vec3(box.hi.x, box.hi.y, box.hi.z) - buffer.lo;
  const double side = std::sqrt(kCellsOfATriangle * static_cast<double>(references.size()) / 6.0);
  buffer.resolution = glm::uvec3(static_cast<std::uint32_t>(std::clamp(side, kLeastSide, kMostSide)));
  LightBufferBuilder builder(box, input.lamp, buffer.resolution.x);
  for (const Reference& reference : references) builder.add(reference.triangle, input.triangles[reference.triangle]);
  builder.finish(buffer);
  return buffer;
}

} // namespace wavepath
