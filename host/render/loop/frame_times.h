// Time that a stage takes, frame by frame.
#pragma once

#include <vector>

#include "host/render/loop/render_result.h"
#include "host/render/workspace/totals.h"

namespace wavepath {

class FrameTimes {
public:
  // `stage`: the name that its time is counted under.
  explicit FrameTimes(const char* stage) : stage_(stage) {}

  // When a frame's work is done; `totals` are those of the whole render so far.
  void note_frame(const Totals& totals);
  // Median with spread, of frames that were not the first: drivers compile at the first dispatch.
  FrameCost cost() const;

private:
  const char* stage_;
  double before_ = 0.0; // seconds, until the last frame
  std::vector<double> frames_;
};

} // namespace wavepath
