// Chooses the length of training: paths for light selection, iterations of guiding.
#pragma once

#include <cstdint>

#include "host/gpu/device_class.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

// Value of Training::paths for a render that stands alone (no part, and not to be merged). Longer renders train longer,
// but with a smaller fraction of their paths, which is never more than 1/26. Training with P paths leaves a squared
// error in proportion to about 1 + a / sqrt(P), and a render of R paths takes 1 + P / R of its time. The product is
// least where P grows as R^(2/3); by measurement, a little faster. A render that ends at an error counts as short. A
// render that ends by time is taken to have expected_paths() paths. `device`: class of the device that renders.
std::uint64_t light_training_paths(const RenderPlan& settings, DeviceClass device);

// Value of Training::guide_iterations for such a render: one more than the default where that pays. A fifth iteration
// learns from twice as many paths and leaves 0.8x of the squared error (benchmarks/results/NOTES.md, Guiding). A sixth
// would leave 0.9x of that, and its vertices would take 1 GB of the host's memory.
std::uint32_t guide_iterations(const RenderPlan& settings, DeviceClass device);

// Sets both members of settings.training.
void set_training_lengths(RenderPlan& settings, DeviceClass device);

} // namespace wavepath
