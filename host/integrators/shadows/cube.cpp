// A cube of shadow maps around a point light.
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
                                             const RenderSettings&) { return cube_views(fit, source.position); }};
constexpr std::array<std::string_view, 3> kSettings = {"shadow-size", "shadow-bias", "shadow-source"};

} // namespace

constinit const ShadowKind kShadowCube = {
    .name = "cube",
    .summary = "six shadow maps around a point light",
    .sources = kPointSource,
    .settings = kSettings,
    .make = [](const ShadowContext& context) { return make_shadow_maps(kRecipe, context); },
};

} // namespace wavepath
