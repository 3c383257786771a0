// A shadow map (Williams 1978).
#include <array>

#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/shadow_maps.h"
#include "kernels/hybrid/shadows/look_up_map.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kMapStages = {{{"shadow look-up", wavepath_look_up_map_spv}}};
const ShadowMapRecipe kMapRecipe = {};

} // namespace

const KernelProgram kCompareOnce = {kMapStages, kOnlyStage, shadow_layout};

constinit const ShadowKind kShadowMap = {
    .name = "map",
    .summary = "a shadow map, one comparison (Williams 1978)",
    .sources = kAllSources,
    .settings = kMapSettings,
    .program = &kCompareOnce,
    .maps = &kMapRecipe,
    .make = make_shadow_maps,
};

} // namespace wavepath
