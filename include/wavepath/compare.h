// Comparison of pictures in memory.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <wavepath/export.h>

namespace wavepath_v0 {

// Linear R, G, B of each pixel, rows from the top.
struct Pixels {
  std::uint32_t width = 0, height = 0;
  std::vector<float> rgb;
};

// How far `image` is from `reference`: what `wavepath compare --json` tells, without the names. Throws Error.
WAVEPATH_API std::string compare(const Pixels& image, const Pixels& reference);

} // namespace wavepath_v0
