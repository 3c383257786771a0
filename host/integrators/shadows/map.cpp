// A shadow map (Williams 1978).
#include <array>

#include "host/integrators/shadows/kinds.h"
#include "host/integrators/shadows/shadow_maps.h"
#include "kernels/shadows/look_up_map.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kStages = {{{"shadow look-up", wavepath_look_up_map_spv}}};
constexpr std::array<std::size_t, 1> kOrder = {0};
const ShadowMapRecipe kRecipe = {};

} // namespace

const KernelProgram kCompareOnce = {kStages, kOrder, shadow_layout};

constinit const ShadowKind kShadowMap = {
    .name = "map",
    .summary = "a shadow map, one comparison (Williams 1978)",
    .sources = kAllSources,
    .settings = kMapSettings,
    .program = &kCompareOnce,
    .make = [](const ShadowContext& context) { return make_shadow_maps(kRecipe, context); },
};

} // namespace wavepath
