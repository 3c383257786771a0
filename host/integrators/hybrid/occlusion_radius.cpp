#include "host/integrators/hybrid/occlusion_radius.h"

#include "host/integrators/hybrid/occlusion/catalogue.h"
#include "host/render/settings/integrator_kind.h"
#include "host/scene/pack/pack.h"

namespace wavepath {

double occlusion_radius(const PackedScene& scene, const RenderPlan& settings) {
  const bool limited = settings.integrator->finds_light || kOcclusionTechniques.find(settings);
  return settings.ao_radius.value_or(limited ? 0.1 * scene.radius : 0.0);
}

} // namespace wavepath
