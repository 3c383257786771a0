// Chooses the quality of the BVH by the number of rays that the render is going to trace.
#pragma once

#include <array>
#include <string_view>

#include "bvh/build.h"
#include "host/gpu/device.h"
#include "host/plan/decision.h"
#include "host/render/render.h"

namespace wavepath {

// Indexed by bvh::Quality.
inline constexpr std::array<std::string_view, 3> kQualityNames = {"fast", "balanced", "best"};

// Returns the best quality whose additional build time is less than the traversal time that it saves, as measured on
// real scenes.
bvh::Quality choose_quality(const RenderPlan& settings, std::uint64_t triangles, const DeviceInfo& device);

// The entry for Plan::decisions.
Decision decision_of(bvh::Quality quality);

} // namespace wavepath
