#include "host/render/settings/textures.h"

#include <algorithm>

namespace wavepath {

std::optional<SamplerLimits> sampler_limits(const RenderPlan& settings, const DeviceInfo& device) {
  if (settings.textures == kTexturesExact) return std::nullopt;
  return SamplerLimits{device.max_image_side, device.max_image_layers,
                       std::min(device.max_image_bytes, device.max_allocation)};
}

std::optional<SamplerLimits> common_limits(std::optional<SamplerLimits> limits, const DeviceInfo& other) {
  if (!limits) return limits;
  return SamplerLimits{std::min(limits->side, other.max_image_side), std::min(limits->layers, other.max_image_layers),
                       std::min({limits->bytes, other.max_image_bytes, other.max_allocation})};
}

} // namespace wavepath
