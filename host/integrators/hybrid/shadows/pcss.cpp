// Percentage-closer soft shadows (Fernando 2005).
#include <array>

#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/shadow_maps.h"
#include "kernels/hybrid/shadows/look_up_pcss.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kPcssStages = {{{"shadow look-up", wavepath_look_up_pcss_spv}}};
const KernelProgram kPcssProgram = {kPcssStages, kOnlyStage, shadow_layout};
const ShadowMapRecipe kPcssRecipe = {.taps = true};
constexpr std::array<std::string_view, 5> kPcssSettings = {"shadow-size", "shadow-bias", "shadow-source", "shadow-taps",
                                                           "shadow-pattern"};

} // namespace

constinit const ShadowKind kShadowPcss = {
    .name = "pcss",
    .summary = "a shadow map, filtered as wide as the blockers' mean depth tells (Fernando 2005)",
    .sources = kAreaSources,
    .settings = kPcssSettings,
    .program = &kPcssProgram,
    .maps = &kPcssRecipe,
    .make = make_shadow_maps,
};

} // namespace wavepath
