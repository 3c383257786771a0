#include "host/render/loop/target.h"

#include <algorithm>
#include <limits>

namespace wavepath {
namespace {

// Few samples a pixel may have missed rare light, so no estimate of fewer ends a render.
constexpr std::uint32_t kFewestSamples = 16;
// Least distance between looks, relative to the samples so far; each look costs time.
constexpr double kShortestStep = 1.0 / 16;

} // namespace

Target::Target(double relative_rms, std::uint32_t first_sample, std::uint32_t last_sample, std::uint32_t step,
               std::uint32_t next_check)
    : relative_rms_(relative_rms),
      first_sample_(first_sample),
      last_sample_(last_sample),
      step_(step),
      next_check_(relative_rms > 0.0 ? next_check : 0) {}

std::uint32_t Target::whole_steps_beyond(std::uint32_t sample, double growth) const {
  const auto samples = static_cast<std::uint64_t>((sample - first_sample_) * growth);
  const std::uint64_t end = sample + (samples / step_ + 1) * step_;
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(end, std::numeric_limits<std::uint32_t>::max()));
}

void Target::begin(std::uint32_t sample, std::uint32_t spp) {
  if (!is_set() || spp < kFewestSamples) return;
  next_check_ = 0;
  looked_at_ = sample;
  limit_ = std::min(whole_steps_beyond(sample, kShortestStep), last_sample_);
}

bool Target::take(std::uint32_t sample, const Checkpoint& found, const std::vector<Checkpoint>& checkpoints) {
  if (!is_set()) return false;
  if (sample == looked_at_) limit_ = 0;
  if (found.spp >= kFewestSamples && found.error.relative_rms <= relative_rms_) {
    limit_ = 0;
    next_check_ = sample; // one that goes on from here looks first
    return true;
  }
  next_check_ = 0;
  if (!has_estimate(found.spp, found.error) || found.spp < kFewestSamples) return false;
  const double growth = growth_for(found.error.relative_rms / relative_rms_, fit_slope(checkpoints, Against::spp));
  next_check_ = whole_steps_beyond(sample, std::clamp(growth - 1.0, kShortestStep, 1.0));
  return false;
}

} // namespace wavepath
