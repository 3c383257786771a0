// A cube of shadow maps around a point light.
#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/shadow_maps.h"

namespace wavepath {
namespace {

const ShadowMapRecipe kCubeRecipe = {.views = [](const ShadowFit& fit, const ShadowSource& source, const View&,
                                                 const RenderPlan&) { return cube_views(fit, source.position); }};

} // namespace

constinit const ShadowKind kShadowCube = {
    .name = "cube",
    .summary = "six shadow maps around a point light",
    .sources = kPointSource,
    .settings = kMapSettings,
    .program = &kCompareOnce,
    .maps = &kCubeRecipe,
    .make = make_shadow_maps,
};

} // namespace wavepath
