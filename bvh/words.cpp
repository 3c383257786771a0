// Fits a grid to the boxes of up to four children.
#include "bvh/words.h"

#include <algorithm>
#include <cmath>

namespace wavepath::bvh {

namespace {

constexpr int kMostCells = 255;

struct Interval {
  float lo, hi;
};

struct Planes {
  float origin;
  std::uint32_t exponent; // biased by kCellBias
  std::uint8_t lo[4], hi[4];
};

// False if some interval, with its margin, does not fit into 255 cells of that size above that origin. Differences of
// floats are exact in double here, or round by far less than the margin.
bool fit(std::span<const Interval> intervals, double cell, Planes& planes) {
  const double per_cell = 1.0 / cell; // a power of two
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const double lo = std::floor((double{intervals[i].lo} - planes.origin) * per_cell - kGridMargin);
    const double hi = std::ceil((double{intervals[i].hi} - planes.origin) * per_cell + kGridMargin);
    if (!(lo >= 0.0 && hi <= kMostCells)) return false;
    planes.lo[i] = static_cast<std::uint8_t>(lo);
    planes.hi[i] = static_cast<std::uint8_t>(hi);
  }
  return true;
}

// The finest cells that work; the origin lies below the lowest bound by no more than the margin needs.
Planes fit_axis(std::span<const Interval> intervals) {
  Planes planes{0.0f, 0, {255, 255, 255, 255}, {0, 0, 0, 0}};
  if (intervals.empty()) return planes;
  float lowest = intervals[0].lo, highest = intervals[0].hi;
  for (const Interval& interval : intervals) {
    lowest = std::min(lowest, interval.lo);
    highest = std::max(highest, interval.hi);
  }
  // Flat boxes too need cells of a size that the origin's last place can resolve.
  const float below = std::nextafter(lowest, std::numeric_limits<float>::lowest());
  int exponent = 0;
  std::frexp((double{highest} - below) / kMostCells, &exponent);
  for (exponent = std::max(exponent - 1, -kCellBias);; ++exponent) {
    const double cell = std::ldexp(1.0, exponent);
    planes.origin = static_cast<float>(lowest - 2 * kGridMargin * cell);
    while (lowest - double{planes.origin} < kGridMargin * cell)
      planes.origin = std::nextafter(planes.origin, std::numeric_limits<float>::lowest());
    if (!fit(intervals, cell, planes)) continue;
    planes.exponent = static_cast<std::uint32_t>(exponent + kCellBias);
    return planes;
  }
}

} // namespace

WideNode place_on_grid(std::span<const Box> boxes) {
  WideNode node{};
  std::uint8_t* lo[3] = {node.lo_x, node.lo_y, node.lo_z};
  std::uint8_t* hi[3] = {node.hi_x, node.hi_y, node.hi_z};
  for (int axis = 0; axis < 3; ++axis) {
    Interval intervals[4];
    for (std::size_t i = 0; i < boxes.size(); ++i) intervals[i] = {boxes[i].lo[axis], boxes[i].hi[axis]};
    const Planes planes = fit_axis({intervals, boxes.size()});
    node.origin[axis] = planes.origin;
    node.layout |= planes.exponent << (7 * axis);
    std::copy_n(planes.lo, 4, lo[axis]);
    std::copy_n(planes.hi, 4, hi[axis]);
  }
  return node;
}

} // namespace wavepath::bvh
