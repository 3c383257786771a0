#include "host/render/settings/shadow_settings.h"

#include "host/render/settings/integrator_kind.h"

namespace wavepath {

std::uint32_t direct_of(const RenderSettings& settings) {
  const bool answered = settings.shadows != kShadowsTraced && takes(*settings.integrator, "shadows");
  return answered && settings.direct == gpu::kDirectMis ? gpu::kDirectNee : settings.direct;
}

} // namespace wavepath
