#include "host/render/settings/mips.h"

#include "host/render/settings/integrator_kind.h"

namespace wavepath {

bool uses_mips(const RenderPlan& settings) {
  const std::uint32_t samples = settings.sample_total > 0 ? settings.sample_total : settings.last_sample;
  return settings.mips && supports(*settings.integrator, "mips") && (samples <= 1 || settings.antialias_over_time);
}

bool wants_mips(const RenderPlan& settings) {
  return uses_mips(settings) || (settings.kernels.mips && settings.mips && supports(*settings.integrator, "mips"));
}

} // namespace wavepath
