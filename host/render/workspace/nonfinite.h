// Samples that were not finite: the number that each kernel made, and the first of them.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string_view>

#include "kernels/base/wave.h"

namespace wavepath {

// Indexed by the kMaker... constants.
inline constexpr std::array<std::string_view, gpu::kMakerCount> kMakerNames = {"generate", "shade", "connect"};

// A replicate of a pixel; 1 is the second one of a probed pixel (kernels/base/error_probes.h).
struct PixelReplicate {
  std::uint32_t pixel = 0; // in tile order
  std::uint32_t replicate = 0;
  auto operator<=>(const PixelReplicate&) const = default;
};

// A non-finite sample. They are ordered by sample, then by entry in tile order, which no size of waves and no number of
// lanes can change.
struct NonfiniteSample {
  std::uint32_t sample = 0;
  PixelReplicate at;
  std::uint32_t maker = 0; // kMaker...
  auto operator<=>(const NonfiniteSample&) const = default;
};

struct Nonfinite {
  std::array<std::uint64_t, gpu::kMakerCount> by_maker{};
  std::optional<NonfiniteSample> first;
  bool operator==(const Nonfinite&) const = default;

  std::uint64_t samples() const { return std::accumulate(by_maker.begin(), by_maker.end(), std::uint64_t{0}); }

  // Adds the counts of one wave. `pixel_at(entry)`: the PixelReplicate of an entry of the wave. Returns true if any
  // count was not 0.
  template <class PixelAt>
  bool add(const gpu::Counters& counters, const gpu::Wave& wave, PixelAt pixel_at) {
    bool any = false;
    for (std::uint32_t maker = 0; maker < gpu::kMakerCount; ++maker) {
      if (counters.nonfinite_count[maker] == 0) continue;
      any = true;
      by_maker[maker] += counters.nonfinite_count[maker];
      for (int level = 0; level < gpu::kLevels; ++level) {
        const std::uint32_t slot = counters.nonfinite_first[maker * gpu::kLevels + static_cast<std::uint32_t>(level)];
        if (slot == gpu::kNone) continue;
        const gpu::WavePart part = gpu::part_of_slot(wave, slot);
        const NonfiniteSample lowest{part.first_sample + gpu::local_sample(part, slot),
                                     pixel_at(wave.first_pixel + gpu::local_entry(part, slot)), maker};
        if (!first || lowest < *first) first = lowest;
      }
    }
    return any;
  }
};

} // namespace wavepath
