// The encoding of colours in images.
#pragma once

#include <cmath>

namespace wavepath {

// IEC 61966-2-1: encoded value -> linear, both 0..1.
inline double linear_from_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

} // namespace wavepath
