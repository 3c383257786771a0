#include "host/render/settings/mips.h"

#include "host/render/settings/integrator_kind.h"

namespace wavepath {

bool uses_mips(const RenderSettings& settings) {
  const std::uint32_t samples = settings.sample_total > 0 ? settings.sample_total : settings.last_sample;
  return settings.mips && takes(*settings.integrator, "mips") && (samples <= 1 || settings.antialias_over_time);
}

bool wants_mips(const RenderSettings& settings) {
  return uses_mips(settings) || (settings.room_for_mips && settings.mips && takes(*settings.integrator, "mips"));
}

} // namespace wavepath
