#include "host/render/loop/frame_times.h"

#include <algorithm>
#include <string_view>

namespace wavepath {

void FrameTimes::note_frame(const Totals& totals) {
  const auto found = std::ranges::find(totals.stages, std::string_view(stage_), &StageTime::name);
  if (found == totals.stages.end()) return;
  if (found->seconds > before_) frames_.push_back(found->seconds - before_);
  before_ = found->seconds;
}

FrameCost FrameTimes::cost() const {
  if (frames_.empty()) return {};
  std::vector<double> seconds = frames_;
  if (seconds.size() > 1) seconds.erase(seconds.begin());
  std::ranges::sort(seconds);
  return {1000.0 * seconds[seconds.size() / 2], 1000.0 * seconds.front(), 1000.0 * seconds.back()};
}

} // namespace wavepath
