// A map of triangles instead of depths (Hourcade and Nicolas 1985).
#include <array>

#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/shadow_maps.h"
#include "kernels/hybrid/shadows/look_up_map_id.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kMapIdStages = {{{"shadow look-up", wavepath_look_up_map_id_spv}}};
const KernelProgram kMapIdProgram = {kMapIdStages, kOnlyStage, shadow_layout};
const ShadowMapRecipe kMapIdRecipe = {.ids = true};
constexpr std::array<std::string_view, 2> kMapIdSettings = {"shadow-size", "shadow-source"};

} // namespace

constinit const ShadowKind kShadowMapId = {
    .name = "map-id",
    .summary = "a map of triangles instead of depths (Hourcade and Nicolas 1985)",
    .sources = kAllSources,
    .settings = kMapIdSettings,
    .program = &kMapIdProgram,
    .maps = &kMapIdRecipe,
    .make = make_shadow_maps,
};

} // namespace wavepath
