// Cascaded shadow maps: a view of a sun for each part of the camera's depths (Zhang, Sun, Xu and Lun 2006).
#include <array>

#include "host/integrators/hybrid/shadows/cascade_views.h"
#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/shadow_maps.h"

namespace wavepath {
namespace {

const ShadowMapRecipe kCascadesRecipe = {
    .views = [](const ShadowFit& fit, const ShadowSource& source, const View& view, const RenderPlan& settings) {
      return cascade_views(fit, source.direction, view, settings.shadow_cascades);
    }};
constexpr std::array<std::string_view, 4> kCascadesSettings = {"shadow-size", "shadow-bias", "shadow-source",
                                                               "shadow-cascades"};

} // namespace

constinit const ShadowKind kShadowCascades = {
    .name = "cascades",
    .summary = "shadow maps of suns, one for each part of the camera's depths (Zhang et al. 2006)",
    .sources = kDirectionalSource,
    .settings = kCascadesSettings,
    .program = &kCompareOnce,
    .maps = &kCascadesRecipe,
    .make = make_shadow_maps,
};

} // namespace wavepath
