// Perspective shadow maps (Stamminger and Drettakis 2002).
#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/shadow_maps.h"
#include "host/integrators/hybrid/shadows/warped_views.h"

namespace wavepath {
namespace {

std::vector<gpu::ShadowView> psm_views(const ShadowFit& fit, const ShadowSource& source, const View& view,
                                       const RenderPlan&) {
  return {camera_space_view(fit, source.direction, view)};
}
const ShadowMapRecipe kPsmRecipe = {.views = psm_views};

} // namespace

constinit const ShadowKind kShadowPsm = {
    .name = "psm",
    .summary = "a sun's shadow map of the camera's image space (Stamminger and Drettakis 2002)",
    .sources = kDirectionalSource,
    .settings = kMapSettings,
    .program = &kCompareOnce,
    .maps = &kPsmRecipe,
    .make = make_shadow_maps,
};

} // namespace wavepath
