// A map of triangles instead of depths (Hourcade and Nicolas 1985).
#include <array>

#include "host/integrators/shadows/kinds.h"
#include "host/integrators/shadows/shadow_maps.h"
#include "kernels/shadows/look_up_map_id.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kStages = {{{"shadow look-up", wavepath_look_up_map_id_spv}}};
constexpr std::array<std::size_t, 1> kOrder = {0};
const KernelProgram kProgram = {kStages, kOrder, shadow_layout};
const ShadowMapRecipe kRecipe = {.ids = true};
constexpr std::array<std::string_view, 2> kSettings = {"shadow-size", "shadow-source"};

} // namespace

constinit const ShadowKind kShadowMapId = {
    .name = "map-id",
    .summary = "a map of triangles instead of depths (Hourcade and Nicolas 1985)",
    .sources = kAllSources,
    .settings = kSettings,
    .program = &kProgram,
    .make = [](const ShadowContext& context) { return make_shadow_maps(kRecipe, context); },
};

} // namespace wavepath
