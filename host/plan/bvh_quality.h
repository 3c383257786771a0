// Which tree is worth building, for as many rays as a render is going to trace.
#pragma once

#include <array>
#include <string_view>

#include "bvh/build.h"
#include "host/gpu/device.h"
#include "host/plan/decision.h"
#include "host/render/render.h"

namespace wavepath {

inline constexpr std::array<std::string_view, 3> kQualityNames = {"fast", "balanced", "best"}; // by bvh::Quality

// The best quality whose additional build time is less than what it saves a render by `settings` in traversal, as
// measured on real scenes.
bvh::Quality choose_quality(const RenderPlan& settings, std::uint64_t triangles, const DeviceInfo& device);

// For the plan.
Decision decision_of(bvh::Quality quality);

} // namespace wavepath
