// Fits a grid to the boxes of a node's children.
#include "bvh/words.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

namespace wavepath::bvh {

namespace {

constexpr int kMostCells = 255;

// The next float towards minus infinity, and the powers of two and exponents below, by their bits: each node would call
// the C library a dozen times and more.
float below(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  if (x == 0.0f) return -std::numeric_limits<float>::denorm_min();
  return std::bit_cast<float>(x > 0.0f ? bits - 1 : bits + 1);
}

double power_of_two(int exponent) { return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52); }

// The largest e with 2^e <= x, which is positive and no subnormal.
int exponent_of(double x) { return static_cast<int>(std::bit_cast<std::uint64_t>(x) >> 52) - 1023; }

// False if some interval, with its margin, does not fit into 255 cells of that size above that origin. Differences of
// floats are exact in double here, or round by far less than the margin.
bool fit(std::span<const Interval> intervals, double per_cell, GridAxis& planes) {
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const double lo = (double{intervals[i].lo} - planes.origin) * per_cell - kGridMargin;
    const double hi = (double{intervals[i].hi} - planes.origin) * per_cell + kGridMargin;
    if (!(lo >= 0.0 && hi <= kMostCells)) return false;
    const int rounded = static_cast<int>(hi);
    planes.lo[i] = static_cast<std::uint8_t>(lo);
    planes.hi[i] = static_cast<std::uint8_t>(rounded < hi ? rounded + 1 : rounded);
  }
  return true;
}

} // namespace

// The origin lies below the lowest bound by no more than the margin needs.
GridAxis fit_axis(std::span<const Interval> intervals) {
  GridAxis planes{0.0f, 0, {}, {}};
  std::fill_n(planes.lo, kMostIntervals, std::uint8_t{kMostCells});
  if (intervals.empty()) return planes;
  float lowest = intervals[0].lo, highest = intervals[0].hi;
  for (const Interval& interval : intervals) {
    lowest = std::min(lowest, interval.lo);
    highest = std::max(highest, interval.hi);
  }
  // Flat boxes too need cells of a size that the origin's last place can resolve.
  const int least = exponent_of((double{highest} - below(lowest)) / kMostCells);
  for (int exponent = std::max(least, -kCellBias);; ++exponent) {
    const double cell = power_of_two(exponent);
    planes.origin = static_cast<float>(lowest - 2 * kGridMargin * cell);
    while (lowest - double{planes.origin} < kGridMargin * cell) planes.origin = below(planes.origin);
    if (!fit(intervals, power_of_two(-exponent), planes)) continue;
    planes.exponent = static_cast<std::uint32_t>(exponent + kCellBias);
    return planes;
  }
}

WideNode place_on_grid(std::span<const Box> boxes) {
  WideNode node{};
  std::uint8_t* lo[3] = {node.lo_x, node.lo_y, node.lo_z};
  std::uint8_t* hi[3] = {node.hi_x, node.hi_y, node.hi_z};
  for (int axis = 0; axis < 3; ++axis) {
    Interval intervals[4];
    for (std::size_t i = 0; i < boxes.size(); ++i) intervals[i] = {boxes[i].lo[axis], boxes[i].hi[axis]};
    const GridAxis planes = fit_axis({intervals, boxes.size()});
    node.origin[axis] = planes.origin;
    node.layout |= planes.exponent << (7 * axis);
    std::copy_n(planes.lo, 4, lo[axis]);
    std::copy_n(planes.hi, 4, hi[axis]);
  }
  return node;
}

} // namespace wavepath::bvh
