#include "host/integrators/shadows/times.h"

#include <algorithm>
#include <string_view>

namespace wavepath {
namespace {

double seconds_of(const Totals& totals, std::string_view stage) {
  const auto found = std::ranges::find(totals.stages, stage, &StageTime::name);
  return found == totals.stages.end() ? 0.0 : found->seconds;
}

} // namespace

void ShadowTimes::note_frame(const Totals& totals) {
  const double built = seconds_of(totals, kShadowBuildStage), looked_up = seconds_of(totals, kShadowLookUpStage);
  if (built > built_) builds_.push_back(built - built_);
  if (looked_up > looked_up_) look_ups_.push_back(looked_up - looked_up_);
  built_ = built;
  looked_up_ = looked_up;
}

ShadowCost ShadowTimes::cost_of(std::vector<double> seconds) {
  if (seconds.empty()) return {};
  if (seconds.size() > 1) seconds.erase(seconds.begin());
  std::ranges::sort(seconds);
  return {1000.0 * seconds[seconds.size() / 2], 1000.0 * seconds.front(), 1000.0 * seconds.back()};
}

} // namespace wavepath
