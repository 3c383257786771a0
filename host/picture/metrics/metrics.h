// How far a picture is from a reference, in linear radiance over pixels and RGB.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/picture/picture.h"

namespace wavepath {

struct PictureMetrics {
  std::uint64_t nonfinite_image = 0, nonfinite_reference = 0; // values; if any, nothing below is computed
  double mse = 0.0;                                           // mean (x-r)^2
  double relmse = 0.0;                                        // mean (x-r)^2 / (r^2 + 0.01)
  double mrse = 0.0;                                          // mean (x-r)^2 / (r + 0.01)^2
  double psnr = 0.0;                                          // dB, of the peak given; infinite for equal pictures
  double max = 0.0, p999 = 0.0;       // largest |x-r|, and what all but a thousandth of them stay below
  std::array<double, 3> mean_ratio{}; // mean x / mean r; NaN where the reference is black

  bool finite() const { return nonfinite_image == 0 && nonfinite_reference == 0; }
};

// Both pictures have R G B first and the same size (throws Error otherwise). `peak`: the value of white in PSNR; 0 =
// the largest of the reference.
PictureMetrics compare_pictures(const Picture& picture, const Picture& reference, double peak = 0.0);

// FLIP per pixel, 0..1, row-major, at 67 pixels a degree: LDR-FLIP (Andersson et al. 2020) of values clamped to [0,1],
// or HDR-FLIP (Andersson et al. 2021), the largest over the exposures that the reference asks for. Finite pictures of
// one size.
std::vector<float> ldr_flip(const Picture& picture, const Picture& reference);
std::vector<float> hdr_flip(const Picture& picture, const Picture& reference);

} // namespace wavepath
