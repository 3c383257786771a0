// Trapezoidal shadow maps (Martin and Tan 2004).
#include <array>

#include "host/integrators/shadows/kinds.h"
#include "host/integrators/shadows/shadow_maps.h"
#include "host/integrators/shadows/warped_views.h"
#include "kernels/shadows/look_up_map.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kStages = {{{"shadow look-up", wavepath_look_up_map_spv}}};
constexpr std::array<std::size_t, 1> kOrder = {0};
const KernelProgram kProgram = {kStages, kOrder, shadow_layout};
std::vector<gpu::ShadowView> views(const ShadowFit& fit, const ShadowSource& source, const View& view,
                                   const RenderSettings&) {
  return {trapezoidal_view(fit, source.direction, view)};
}
const ShadowMapRecipe kRecipe = {.program = &kProgram, .views = views};
constexpr std::array<std::string_view, 3> kSettings = {"shadow-size", "shadow-bias", "shadow-source"};

} // namespace

constinit const ShadowKind kShadowTsm = {
    .name = "tsm",
    .summary = "a sun's shadow map, a trapezoid around what is seen (Martin and Tan 2004)",
    .sources = kDirectionalSource,
    .settings = kSettings,
    .make = [](const ShadowContext& context) { return make_shadow_maps(kRecipe, context); },
};

} // namespace wavepath
