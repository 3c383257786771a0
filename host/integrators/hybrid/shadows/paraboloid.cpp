// Dual paraboloid shadow maps: two views of half of all directions each (Brabec, Annen and Seidel 2002). Corners are
// placed as a paraboloid mirror shows them, but a rasterizer joins them by straight edges, so that large triangles are
// shown bent the wrong way, unless maps are traced.
#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/shadow_maps.h"

namespace wavepath {
namespace {

const ShadowMapRecipe kParaboloidRecipe = {
    .views = [](const ShadowFit& fit, const ShadowSource& source, const View&, const RenderPlan&) {
      return paraboloid_views(fit, source.position);
    }};

} // namespace

constinit const ShadowKind kShadowParaboloid = {
    .name = "paraboloid",
    .summary = "two shadow maps around a point light, as paraboloid mirrors show it (Brabec et al. 2002)",
    .sources = kPointSource,
    .settings = kMapSettings,
    .program = &kCompareOnce,
    .maps = &kParaboloidRecipe,
    .make = make_shadow_maps,
};

} // namespace wavepath
