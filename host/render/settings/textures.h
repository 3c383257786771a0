// Decides which textures the device's samplers filter.
#pragma once

#include <optional>

#include "host/gpu/device_info.h"
#include "host/render/settings/render_plan.h"
#include "host/scene/pack/atlas.h"

namespace wavepath {

// Argument of pack(): the limits of the device's samplers with --textures hardware; empty if kernels filter.
std::optional<SamplerLimits> sampler_limits(const RenderPlan& settings, const DeviceInfo& device);
// Limits that hold on several devices which use one packed scene: combines `limits` with those of `other`.
std::optional<SamplerLimits> common_limits(std::optional<SamplerLimits> limits, const DeviceInfo& other);

} // namespace wavepath
