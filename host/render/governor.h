// How many paths a wave may have so that dispatches stay short.
#pragma once

#include <algorithm>
#include <cstdint>

#include "kernels/gpu.h"

namespace wavepath {

inline constexpr double kLongestDispatch = 0.1; // seconds, far below any driver's watchdog

// Halves the wave when a dispatch took too long, doubles it while there is room.
class Governor {
public:
  explicit Governor(std::uint32_t slots, double longest = kLongestDispatch)
      : slots_(slots), wave_(std::min(slots, kFirstWave)), longest_(longest) {}
  std::uint32_t wave() const { return wave_; }
  void report(double longest_dispatch, std::uint32_t paths) {
    if (longest_dispatch > longest_)
      wave_ = std::min(std::max(std::min(paths, wave_) / 2, gpu::kWorkgroupSize), slots_);
    else if (longest_dispatch < longest_ / 4 && paths > wave_ / 2)
      wave_ = std::min(wave_ * 2, slots_);
  }

private:
  static constexpr std::uint32_t kFirstWave = 8192; // paths, before anything is known of the device's speed

  std::uint32_t slots_, wave_;
  double longest_; // seconds
};

} // namespace wavepath
