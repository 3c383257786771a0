// The error of a picture against a reference.
#pragma once

#include "host/picture/metrics/metrics.h"

namespace wavepath {

// Error of a picture against --reference.
struct TrueError {
  PictureMetrics metrics;
  double flip = 0.0; // mean
};

} // namespace wavepath
