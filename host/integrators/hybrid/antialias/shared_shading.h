// Refusals of all techniques whose frames belong together.
#pragma once

#include <string>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/antialias/technique.h"

namespace wavepath {

// `technique`: its flag with its value. `positions`: see AntialiasKind. Throws UsageError.
inline void check_shared_shading(const RenderPlan& settings, const std::string& technique, std::uint32_t positions) {
  const std::uint32_t samples = whole_samples(settings);
  if (samples % positions != 0)
    throw UsageError(technique, fmt::format("has {} places a pixel, and {} samples fill none", positions, samples),
                     fmt::format("give --spp {}", (samples / positions + 1) * positions));
  if (settings.target_error > 0.0)
    throw UsageError("--target-error",
                     fmt::format("is not supported by {}, whose samples share their noise", technique), "leave it out");
}

} // namespace wavepath
