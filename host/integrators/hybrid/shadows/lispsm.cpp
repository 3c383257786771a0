// Light-space perspective shadow maps (Wimmer, Scherzer and Purgathofer 2004): one perspective whose axis is at right
// angles to the light. --shadow-exponent is the distance of its eye, in extents of what is seen.
#include <array>

#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/shadow_maps.h"
#include "host/integrators/hybrid/shadows/warped_views.h"

namespace wavepath {
namespace {

std::vector<gpu::ShadowView> lispsm_views(const ShadowFit& fit, const ShadowSource& source, const View& view,
                                          const RenderPlan& settings) {
  return {light_space_perspective_view(fit, source.direction, view, settings.shadow_exponent)};
}
const ShadowMapRecipe kLispsmRecipe = {.views = lispsm_views};
constexpr std::array<std::string_view, 4> kLispsmSettings = {"shadow-size", "shadow-bias", "shadow-source",
                                                             "shadow-exponent"};

} // namespace

constinit const ShadowKind kShadowLispsm = {
    .name = "lispsm",
    .summary = "a sun's shadow map in perspective, across the light (Wimmer et al. 2004)",
    .sources = kDirectionalSource,
    .settings = kLispsmSettings,
    .program = &kCompareOnce,
    .maps = &kLispsmRecipe,
    .make = make_shadow_maps,
};

} // namespace wavepath
