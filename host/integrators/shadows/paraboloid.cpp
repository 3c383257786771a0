// Dual paraboloid shadow maps: two views of half of all directions each (Brabec, Annen and Seidel 2002). Corners are
// placed as a paraboloid mirror shows them, but a rasterizer joins them by straight edges, so that large triangles are
// shown bent the wrong way, unless maps are traced.
#include <array>

#include "host/integrators/shadows/kinds.h"
#include "host/integrators/shadows/shadow_maps.h"
#include "kernels/shadows/look_up_map.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kStages = {{{"shadow look-up", wavepath_look_up_map_spv}}};
constexpr std::array<std::size_t, 1> kOrder = {0};
const KernelProgram kProgram = {kStages, kOrder, shadow_layout};
const ShadowMapRecipe kRecipe = {.program = &kProgram,
                                 .views = [](const ShadowFit& fit, const ShadowSource& source, const View&,
                                             const RenderSettings&) { return paraboloid_views(fit, source.position); }};
constexpr std::array<std::string_view, 3> kSettings = {"shadow-size", "shadow-bias", "shadow-source"};

} // namespace

constinit const ShadowKind kShadowParaboloid = {
    .name = "paraboloid",
    .summary = "two shadow maps around a point light, as paraboloid mirrors show it (Brabec et al. 2002)",
    .sources = kPointSource,
    .settings = kSettings,
    .make = [](const ShadowContext& context) { return make_shadow_maps(kRecipe, context); },
};

} // namespace wavepath
