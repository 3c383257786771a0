// Measures the cost of each feature that this scene leaves out.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/bench/frames.h"

namespace wavepath {

struct AblationRow {
  std::string left_out;
  double cost_ms = 0.0; // cost in a render of `base_ms`, median over turns
  double base_ms = 0.0;
  std::int64_t cost_bytes = 0; // device memory, buffers of the path state and data of the scene
  double cost_compile_ms = 0.0;
};

// Times renders with the kernels of `base` against kernels with one more feature, in turns; last, against generic
// kernels with all of them.
std::vector<AblationRow> ablate(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                                WarmLoop& base, std::uint32_t spp, std::uint32_t repetitions,
                                const std::function<void(const std::string&)>& progress);

} // namespace wavepath
