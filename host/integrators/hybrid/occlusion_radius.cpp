#include "host/integrators/hybrid/occlusion_radius.h"

#include "host/render/settings/integrator_kind.h"
#include "host/scene/pack/pack.h"

namespace wavepath {

double occlusion_radius(const PackedScene& scene, const RenderSettings& settings) {
  return settings.ao_radius.value_or(settings.integrator->finds_light ? 0.1 * scene.radius : 0.0);
}

} // namespace wavepath
