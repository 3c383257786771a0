// Percentage-closer filtering of a shadow map (Reeves, Salesin and Cook 1987).
#include <array>

#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/shadow_maps.h"
#include "kernels/hybrid/shadows/look_up_pcf.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kPcfStages = {{{"shadow look-up", wavepath_look_up_pcf_spv}}};
const KernelProgram kPcfProgram = {kPcfStages, kOnlyStage, shadow_layout};
const ShadowMapRecipe kPcfRecipe = {.taps = true,
                                    .guard = [](const RenderPlan& settings) { return settings.shadow_blur; }};
constexpr std::array<std::string_view, 6> kPcfSettings = {"shadow-size", "shadow-bias",    "shadow-source",
                                                          "shadow-taps", "shadow-pattern", "shadow-blur"};

} // namespace

constinit const ShadowKind kShadowPcf = {
    .name = "pcf",
    .summary = "a shadow map, comparisons averaged over a filter (Reeves, Salesin and Cook 1987)",
    .sources = kAllSources,
    .settings = kPcfSettings,
    .program = &kPcfProgram,
    .maps = &kPcfRecipe,
    .make = make_shadow_maps,
};

} // namespace wavepath
