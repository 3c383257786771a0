// Projected shadows (Segal et al. 1992): a texture of what casts, as the light sees it, thrown onto the scene's large
// planes like a slide. No depth is compared, so that planes between the light and a caster are darkened as well.
#include <array>

#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/shadow_maps.h"
#include "kernels/hybrid/shadows/look_up_projected.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kProjectedStages = {{{"shadow look-up", wavepath_look_up_projected_spv}}};
const KernelProgram kProjectedProgram = {kProjectedStages, kOnlyStage, shadow_layout};

// Views of projectors. Those of suns show the whole scene, whatever the camera sees of it: a projected picture must
// stay in place.
std::vector<gpu::ShadowView> views_of_projector(const ShadowFit& fit, const ShadowSource& source, const View&,
                                                const RenderPlan&) {
  if (source.kind != kDirectionalSource) return usual_views(fit, source);
  ShadowFit whole = fit;
  whole.receivers.clear();
  for (int i = 0; i < 8; ++i)
    whole.receivers.emplace_back(i & 1 ? fit.hi.x : fit.lo.x, i & 2 ? fit.hi.y : fit.lo.y, i & 4 ? fit.hi.z : fit.lo.z);
  return {parallel_view(whole, source.direction)};
}

const ShadowMapRecipe kProjectedRecipe = {
    .casters = true,
    .cookie = true,
    .guard = [](const RenderPlan&) { return -1.0; }, // nothing around the picture, of which look-ups know the edge
    .views = views_of_projector,
};
constexpr std::array<std::string_view, 2> kProjectedSettings = {"shadow-size", "shadow-cookie"};

} // namespace

constinit const ShadowKind kShadowProjected = {
    .name = "projected",
    .summary = "a texture of casters projected onto the scene's large planes (Segal et al. 1992)",
    .sources = kPunctualSources,
    .settings = kProjectedSettings,
    .program = &kProjectedProgram,
    .maps = &kProjectedRecipe,
    .make = make_shadow_maps,
};

} // namespace wavepath
