// Statistics of the time that a stage takes in each frame.
#pragma once

#include <vector>

#include "host/render/loop/render_result.h"
#include "host/render/workspace/totals.h"

namespace wavepath {

class FrameTimes {
public:
  // `stage`: name under which WaveQueue counts the time.
  explicit FrameTimes(const char* stage) : stage_(stage) {}

  // Called when a frame is done. `totals`: of the whole render so far.
  void note_frame(const Totals& totals);
  // Median, least and most, without the first frame: drivers compile at the first dispatch.
  FrameCost cost() const;

private:
  const char* stage_;
  double before_ = 0.0; // seconds of all frames before
  std::vector<double> frames_;
};

} // namespace wavepath
