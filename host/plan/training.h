// How long pilots are that learn where light comes from.
#pragma once

#include <cstdint>

#include "host/render/settings/render_plan.h"

namespace wavepath {

// Paths for Training::paths of a render that stands alone, neither a part nor to be joined with
// others: the longer it is, the more, and the smaller a fraction of it. What is learned from P paths leaves a squared
// error in proportion to 1 + a / sqrt(P), more or less, and a render of R paths takes 1 + P / R of its time: the
// product is least where P grows as R^(2/3), by measurement a little faster. A render that ends by its error is taken
// to be short, and one that is bounded by time to have the paths that expected_paths() tells.
std::uint64_t light_training_paths(const RenderPlan& settings, bool cpu);

// Training::guide_iterations of such a render: one more where that pays, which learns from twice as many paths
// and leaves .8 of the squared error (benchmarks/results/NOTES.md, Guiding). A sixth one would leave .9 of that, and
// its vertices take 1 GB of the host's memory.
std::uint32_t guide_iterations(const RenderPlan& settings, bool cpu);

// Both.
void set_training_lengths(RenderPlan& settings, bool cpu);

} // namespace wavepath
