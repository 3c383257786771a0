// Leak tracing (Kern, Bruell and Grosch 2024) on maps of four moments.
#include "host/integrators/hybrid/shadows/filterable.h"
#include "host/integrators/hybrid/shadows/kinds.h"
#include "kernels/hybrid/shadows/blur_columns.spv.h"
#include "kernels/hybrid/shadows/look_up_leak.spv.h"
#include "kernels/hybrid/shadows/moment_rows.spv.h"

namespace wavepath {
namespace {

const FilterableStages kLeakStages = {{{"shadow look-up", wavepath_look_up_leak_spv},
                                       {"shadow rows", wavepath_moment_rows_spv},
                                       {"shadow columns", wavepath_blur_columns_spv}}};
const KernelProgram kLeakProgram = {kLeakStages, kFilterableOrder, shadow_layout};
const ShadowMapRecipe kLeakRecipe = [] {
  ShadowMapRecipe recipe = filterable_recipe();
  recipe.counts = true;
  return recipe;
}();

} // namespace

constinit const ShadowKind kShadowLeak = {
    .name = "leak",
    .summary = "a map and its moments where they agree, rays elsewhere (Kern, Bruell and Grosch 2024)",
    .sources = kPunctualSources,
    .settings = kFilterableSettings,
    .program = &kLeakProgram,
    .make = [](const ShadowContext& context) { return make_shadow_maps(kLeakRecipe, context); },
};

} // namespace wavepath
