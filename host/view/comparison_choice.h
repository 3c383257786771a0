// The user's choice for the comparison of shadows.
#pragma once

#include <cstdint>

namespace wavepath {

struct ComparisonChoice {
  bool split = false;        // the other technique is shown beside the picture
  double at = 0.5;           // fraction of the width at which the other picture begins
  std::uint32_t against = 0; // the other technique: a value of RenderPlan::shadows
};

} // namespace wavepath
