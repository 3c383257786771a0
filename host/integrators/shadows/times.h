// What a shadow technique takes, frame by frame: to build what it looks shadows up in, and to look them up.
#pragma once

#include <vector>

#include "host/render/device/totals.h"
#include "host/render/loop/render_result.h"

namespace wavepath {

inline constexpr const char *kShadowBuildStage = "shadow build", *kShadowLookUpStage = "shadow look-up";

class ShadowTimes {
public:
  // When a frame's work is done; `totals` are those of the whole render so far.
  void note_frame(const Totals& totals);
  // Medians with spread, of frames that were not the first: drivers compile at the first dispatch.
  ShadowCost build() const { return cost_of(builds_); }
  ShadowCost look_up() const { return cost_of(look_ups_); }

private:
  static ShadowCost cost_of(std::vector<double> seconds);

  double built_ = 0.0, looked_up_ = 0.0; // until the last frame
  std::vector<double> builds_, look_ups_;
};

} // namespace wavepath
