// Metrics of the difference between a picture and a reference, in linear radiance over pixels and RGB.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/picture/picture.h"

namespace wavepath {

struct PictureMetrics {
  // Number of non-finite values; if not 0, nothing below is computed.
  std::uint64_t nonfinite_image = 0, nonfinite_reference = 0;
  double mse = 0.0;                   // mean (x-r)^2
  double relmse = 0.0;                // mean (x-r)^2 / (r^2 + 0.01)
  double mrse = 0.0;                  // mean (x-r)^2 / (r + 0.01)^2
  double psnr = 0.0;                  // dB, relative to `peak`; infinite for equal pictures
  double max = 0.0, p999 = 0.0;       // largest |x-r|, and its 99.9th percentile
  std::array<double, 3> mean_ratio{}; // mean x / mean r for R, G, B; NaN if the reference is black

  bool finite() const { return nonfinite_image == 0 && nonfinite_reference == 0; }
};

// Compares two pictures, which must have R G B first and the same size; throws Error otherwise. `peak`: value of white
// in PSNR; 0 = the largest value of the reference.
PictureMetrics compare_pictures(const Picture& picture, const Picture& reference, double peak = 0.0);

// FLIP of each pixel, 0 to 1, row-major, at 67 pixels a degree. LDR-FLIP (Andersson et al. 2020) uses values clamped to
// [0,1]. HDR-FLIP (Andersson et al. 2021) is the largest over exposures chosen from the reference. Pictures must be
// finite and of equal size.
std::vector<float> ldr_flip(const Picture& picture, const Picture& reference);
std::vector<float> hdr_flip(const Picture& picture, const Picture& reference);

} // namespace wavepath
