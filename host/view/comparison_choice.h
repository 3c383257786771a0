// What the shadows of the picture are compared with, as the user chooses it.
#pragma once

#include <cstdint>

namespace wavepath {

struct ComparisonChoice {
  bool split = false;        // the other technique is shown beside the picture
  double at = 0.5;           // from this fraction of the width on
  std::uint32_t against = 0; // that technique: RenderPlan::shadows
};

} // namespace wavepath
