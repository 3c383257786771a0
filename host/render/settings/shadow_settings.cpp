#include "host/render/settings/shadow_settings.h"

#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/shading_settings.h"

namespace wavepath {

std::uint32_t direct_of(const RenderPlan& settings) {
  const bool answered = settings.shadows != kShadowsTraced && supports(*settings.integrator, "shadows");
  const bool local = settings.shading != kShadingGltf && supports(*settings.integrator, "shading");
  return (answered || local) && settings.direct == gpu::kDirectMis ? gpu::kDirectNee : settings.direct;
}

} // namespace wavepath
