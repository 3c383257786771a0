// Governs the length of waves, so that dispatches stay short.
#pragma once

#include <algorithm>
#include <cstdint>

#include "kernels/base/gpu.h"

namespace wavepath {

inline constexpr double kLongestDispatch = 0.1; // seconds, far below any driver's watchdog
// Paths of the first waves, before the speed of the device is known. CPUs have no watchdog, and even a short wave costs
// them some milliseconds. So their first wave is longer: on two cores it takes a tenth of a second in most scenes, and
// a whole second in the slowest.
inline constexpr std::uint32_t kFirstWave = 8192, kFirstWaveOfCpu = 1u << 16;

// Halves the wave if a dispatch took too long. If time and memory allow at least twice as many paths, takes at once as
// many as surely fit: longer waves take less time for each path.
class Governor {
public:
  // `first`: paths of the waves that are sent before the first one's time is known.
  explicit Governor(std::uint32_t slots, double longest = kLongestDispatch, std::uint32_t first = kFirstWave)
      : slots_(slots), wave_(std::min(slots, first)), longest_(longest) {}
  std::uint32_t wave() const { return wave_; }
  void report(double longest_dispatch, std::uint32_t paths) {
    if (longest_dispatch > longest_)
      wave_ = std::min(std::max(std::min(paths, wave_) / 2, gpu::kWorkgroupSize), slots_);
    else if (longest_dispatch < longest_ / 4 && paths > wave_ / 2)
      wave_ = static_cast<std::uint32_t>(std::min<double>(slots_, paths * growth(longest_dispatch)));
  }

private:
  // Factor that fills half of the allowed time. At most 8, because the first waves may differ from the rest of the
  // picture.
  double growth(double longest_dispatch) const {
    return longest_dispatch > 0.0 ? std::min(longest_ / 2 / longest_dispatch, 8.0) : 8.0;
  }

  std::uint32_t slots_, wave_;
  double longest_; // seconds
};

} // namespace wavepath
