// Variance shadow maps (Donnelly and Lauritzen 2006).
#include "host/integrators/hybrid/shadows/filterable.h"
#include "host/integrators/hybrid/shadows/kinds.h"
#include "kernels/hybrid/shadows/blur_columns.spv.h"
#include "kernels/hybrid/shadows/look_up_vsm.spv.h"
#include "kernels/hybrid/shadows/vsm_rows.spv.h"

namespace wavepath {
namespace {

const FilterableStages kVsmStages = {{{"shadow look-up", wavepath_look_up_vsm_spv},
                                      {"shadow rows", wavepath_vsm_rows_spv},
                                      {"shadow columns", wavepath_blur_columns_spv}}};
const KernelProgram kVsmProgram = {kVsmStages, kFilterableOrder, shadow_layout};
const ShadowMapRecipe kVsmRecipe = filterable_recipe();

} // namespace

constinit const ShadowKind kShadowVsm = {
    .name = "vsm",
    .summary = "the most light that mean and variance of a map's depths allow (Donnelly and Lauritzen 2006)",
    .sources = kAllSources,
    .settings = kFilterableSettings,
    .program = &kVsmProgram,
    .make = [](const ShadowContext& context) { return make_shadow_maps(kVsmRecipe, context); },
};

} // namespace wavepath
