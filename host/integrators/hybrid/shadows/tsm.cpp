// Trapezoidal shadow maps (Martin and Tan 2004).
#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/shadow_maps.h"
#include "host/integrators/hybrid/shadows/warped_views.h"

namespace wavepath {
namespace {

std::vector<gpu::ShadowView> tsm_views(const ShadowFit& fit, const ShadowSource& source, const View& view,
                                       const RenderPlan&) {
  return {trapezoidal_view(fit, source.direction, view)};
}
const ShadowMapRecipe kTsmRecipe = {.views = tsm_views};

} // namespace

constinit const ShadowKind kShadowTsm = {
    .name = "tsm",
    .summary = "a sun's shadow map, a trapezoid around what is seen (Martin and Tan 2004)",
    .sources = kDirectionalSource,
    .settings = kMapSettings,
    .program = &kCompareOnce,
    .maps = &kTsmRecipe,
    .make = make_shadow_maps,
};

} // namespace wavepath
