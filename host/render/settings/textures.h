// By what textures are filtered.
#pragma once

#include <optional>

#include "host/gpu/device_info.h"
#include "host/render/settings/render_plan.h"
#include "host/scene/pack/atlas.h"

namespace wavepath {

// --textures, as pack() takes it: what the samplers of the device can hold where they are to look textures up.
std::optional<SamplerLimits> sampler_limits(const RenderPlan& settings, const DeviceInfo& device);
// Of several that share a packed scene: what all of them can hold.
std::optional<SamplerLimits> common_limits(std::optional<SamplerLimits> limits, const DeviceInfo& other);

} // namespace wavepath
