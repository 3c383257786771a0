// Whether the error that renders estimate of themselves is the true one, over many seeds.
#pragma once

#include <cmath>
#include <cstdint>

#include "host/picture/metrics/metrics.h"
#include "host/picture/picture.h"
#include "host/render/render.h"
#include "tests/statistics.h"

namespace wavepath::test {

struct Coverage {
  std::uint32_t covered = 0; // renders whose interval holds their true error
  Mean ratio;                // estimate over truth
  Mean half_width;           // half of the interval over the estimate
};

// `render(seed)` gives a RenderResult, for the seeds below `runs`.
template <typename Render>
Coverage measure_coverage(const Picture& reference, std::uint32_t runs, const Render& render) {
  Coverage coverage;
  for (std::uint32_t seed = 0; seed < runs; ++seed) {
    const RenderResult result = render(seed);
    const double truth = std::sqrt(compare_pictures(result.picture, reference).relmse);
    const auto& [low, high] = result.error.ci95;
    coverage.covered += truth >= low && truth <= high;
    coverage.ratio.add(result.error.relative_rms / truth);
    coverage.half_width.add(0.5 * (high - low) / result.error.relative_rms);
  }
  return coverage;
}

} // namespace wavepath::test
