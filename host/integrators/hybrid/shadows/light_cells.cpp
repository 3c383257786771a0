#include "host/integrators/hybrid/shadows/light_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace wavepath {
namespace {

constexpr double kGrowth = 0x1p-18, kRowError = 0x1p-20; // of R
constexpr std::uint32_t kFewestBlocks = 128;             // along a side of a view that is covered whole

// Homogeneous: (x, y) / z is the position in the view, from -1 to 1.
struct Polygon {
  std::array<glm::dvec3, 12> corners; // a triangle, and one more for each of nine planes at most
  std::size_t count = 0;
};

// Clips a polygon to dot(normal, p) + offset >= 0.
Polygon clip(const Polygon& polygon, const glm::dvec3& normal, double offset) {
  Polygon out;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const glm::dvec3 &a = polygon.corners[i], &b = polygon.corners[(i + 1) % polygon.count];
    const double at_a = glm::dot(normal, a) + offset, at_b = glm::dot(normal, b) + offset;
    if (at_a >= 0.0) out.corners[out.count++] = a;
    if ((at_a >= 0.0) != (at_b >= 0.0)) out.corners[out.count++] = glm::mix(a, b, at_a / (at_a - at_b));
  }
  return out;
}

struct Interval {
  double lo = 1e300, hi = -1e300;
};

// A view as cells, and how far a world point that moves by a metre moves in each homogeneous coordinate.
struct CellView {
  glm::dvec4 x, y, w;
  glm::dvec3 reach; // lengths of the rows
  double size, pad; // cells
  bool parallel;

  CellView(const gpu::ShadowView& view, std::uint32_t cells)
      : x(view.x),
        y(view.y),
        w(view.w),
        reach(glm::length(glm::dvec3(x)), glm::length(glm::dvec3(y)), glm::length(glm::dvec3(w))),
        size(cells),
        pad(1.0),
        parallel(view.kind == gpu::kViewParallel) {
    // For parallel views, whose points have no least w: the distance by which rounding moves a point.
    if (parallel) pad += 0.5 * size * (kRowError / kGrowth) * double{view.radius} * std::max(reach.x, reach.y);
  }

  glm::dvec3 project(const glm::dvec3& p) const {
    const glm::dvec4 q(p, 1.0);
    return {glm::dot(x, q), glm::dot(y, q), glm::dot(w, q)};
  }
  double ndc(double cell) const { return 2.0 * cell / size - 1.0; }

  // Cells between which a polygon in front of the light, grown by `growth`, lies along an axis (0: x, 1: y).
  Interval cells(const Polygon& polygon, int axis, const glm::dvec3& growth) const {
    Interval range;
    for (std::size_t i = 0; i < polygon.count; ++i)
      for (const double depth : {polygon.corners[i].z - growth.z, polygon.corners[i].z + growth.z}) {
        range.lo = std::min(range.lo, (polygon.corners[i][axis] - growth[axis]) / depth);
        range.hi = std::max(range.hi, (polygon.corners[i][axis] + growth[axis]) / depth);
      }
    return {std::floor(0.5 * (range.lo + 1.0) * size - pad), std::floor(0.5 * (range.hi + 1.0) * size + pad)};
  }
  std::uint32_t clamped(double cell) const { return static_cast<std::uint32_t>(std::clamp(cell, 0.0, size - 1.0)); }
};

class Cover {
public:
  Cover(const gpu::ShadowView& view, std::uint32_t size, std::vector<glm::uvec4>& items)
      : view_(view, size),
        first_cell_(view.first_texel),
        size_(size),
        block_(std::max(4u, size / kFewestBlocks)),
        items_(items) {}

  // `growth`: metres.
  void add(std::uint32_t triangle, std::uint32_t instance, const std::array<glm::dvec3, 3>& corners, double growth) {
    const glm::dvec3 by = growth * view_.reach;
    Polygon polygon;
    for (const glm::dvec3& p : corners) polygon.corners[polygon.count++] = view_.project(p);
    // Two cells wider than the view: points at its rim may be on either side.
    const double side = 1.0 + (2.0 + 2.0 * view_.pad) / size_;
    for (const int axis : {0, 1})
      for (const double sign : {1.0, -1.0}) {
        glm::dvec3 inwards(0.0, 0.0, side);
        inwards[axis] = sign;
        polygon = clip(polygon, inwards, by[axis] + side * by.z);
        if (polygon.count == 0) return;
      }
    polygon = clip(polygon, {0.0, 0.0, 1.0}, by.z);
    if (polygon.count == 0) return;
    double nearest = 1e300;
    for (std::size_t i = 0; i < polygon.count; ++i) nearest = std::min(nearest, polygon.corners[i].z);
    if (!view_.parallel && nearest <= 8.0 * by.z) return add_rows(triangle, instance, 0, size_ - 1, std::nullopt, by);
    const Interval rows = view_.cells(polygon, 1, by);
    add_rows(triangle, instance, view_.clamped(rows.lo), view_.clamped(rows.hi), polygon, by);
  }

private:
  // Without a polygon: all cells of these rows.
  void add_rows(std::uint32_t triangle, std::uint32_t instance, std::uint32_t first, std::uint32_t last,
                const std::optional<Polygon>& polygon, const glm::dvec3& by) {
    const bool one = last - first < block_;
    for (std::uint32_t row = first; row <= last; row += block_) {
      const std::uint32_t end = std::min(last, row + block_ - 1);
      std::uint32_t left = 0, right = size_ - 1;
      if (polygon) {
        const Polygon part = one ? *polygon : strip(*polygon, row, end, by);
        if (part.count == 0) continue;
        const Interval columns = view_.cells(part, 0, by);
        left = view_.clamped(columns.lo), right = view_.clamped(columns.hi);
      }
      for (; left <= right; left += block_)
        items_.emplace_back(triangle, instance, first_cell_ + row * size_ + left,
                            std::min(right - left + 1, block_) | (end - row + 1) << 16);
    }
  }

  // The part of it that may cover these rows; the outermost rows also stand for what is beyond.
  Polygon strip(const Polygon& polygon, std::uint32_t first, std::uint32_t last, const glm::dvec3& by) const {
    Polygon part = polygon;
    if (const double at = view_.ndc(first - view_.pad - 1.0); first > 0)
      part = clip(part, {0.0, 1.0, -at}, by.y + std::abs(at) * by.z);
    if (const double at = view_.ndc(last + view_.pad + 2.0); last + 1 < size_)
      part = clip(part, {0.0, -1.0, at}, by.y + std::abs(at) * by.z);
    return part;
  }

  CellView view_;
  std::uint32_t first_cell_, size_, block_;
  std::vector<glm::uvec4>& items_;
};

glm::dmat4x3 rows_of(const gpu::vec4* rows) {
  return glm::transpose(glm::dmat3x4(glm::dvec4(rows[0]), glm::dvec4(rows[1]), glm::dvec4(rows[2])));
}

// Frobenius norms: at least the condition number of the linear part.
double condition(const gpu::Instance& instance) {
  double there = 0.0, back = 0.0;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 a(instance.world_from_object[i]), b(instance.object_from_world[i]);
    there += glm::dot(a, a);
    back += glm::dot(b, b);
  }
  return std::sqrt(there * back);
}

} // namespace

void bound_rounding(gpu::ShadowView& view, std::uint32_t size, const glm::dvec3& lo, const glm::dvec3& hi) {
  const glm::dvec3 far = glm::max(glm::abs(lo), glm::abs(hi));
  const bool parallel = view.kind == gpu::kViewParallel;
  const double extent = far.x + far.y + far.z, light = glm::dot(glm::abs(glm::dvec3(view.light)), glm::dvec3(1.0));
  view.radius = static_cast<float>(kGrowth * (parallel ? extent : extent + light));
  // A sun's rays may leave its direction by so much for every metre, of which they run at most 2 * extent.
  view.texel = static_cast<float>(parallel ? 0.5 * kRowError : kRowError * (extent + light));
  if (parallel) return;
  const double across = std::max(glm::length(glm::dvec3(view.x)), glm::length(glm::dvec3(view.y)));
  view.near = static_cast<float>(size * kRowError * (extent + light) * (across + 1.0));
}

std::vector<glm::uvec4> cover_cells(const PackedScene& scene, const std::vector<gpu::ShadowView>& views,
                                    std::uint32_t size) {
  std::vector<glm::uvec4> items;
  for (const gpu::ShadowView& view : views) {
    Cover cover(view, size, items);
    for (const Draw& draw : scene.draws)
      for (std::uint32_t i = draw.first_instance; i < draw.first_instance + draw.instance_count; ++i) {
        const gpu::Instance* instance = scene.root_is_top ? &scene.instances[i] : nullptr;
        const glm::dmat4x3 placed = instance ? rows_of(instance->world_from_object) : glm::dmat4x3(1.0);
        const double growth = double{view.radius} * (instance ? 1.0 + condition(*instance) : 1.0);
        for (std::uint32_t t = draw.first_triangle; t < draw.first_triangle + draw.triangle_count; ++t) {
          const gpu::Triangle& triangle = scene.triangles[t];
          cover.add(t, i,
                    {placed * glm::dvec4(triangle.v0, 1.0), placed * glm::dvec4(triangle.v1, 1.0),
                     placed * glm::dvec4(triangle.v2, 1.0)},
                    growth);
        }
      }
  }
  return items;
}

} // namespace wavepath
