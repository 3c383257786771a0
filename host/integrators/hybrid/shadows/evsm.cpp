// Exponential variance shadow maps (Lauritzen and McCool 2008).
#include "host/integrators/hybrid/shadows/filterable.h"
#include "host/integrators/hybrid/shadows/kinds.h"
#include "kernels/hybrid/shadows/blur_columns.spv.h"
#include "kernels/hybrid/shadows/evsm_rows.spv.h"
#include "kernels/hybrid/shadows/look_up_evsm.spv.h"

namespace wavepath {
namespace {

const FilterableStages kEvsmStages = {{{"shadow look-up", wavepath_look_up_evsm_spv},
                                       {"shadow rows", wavepath_evsm_rows_spv},
                                       {"shadow columns", wavepath_blur_columns_spv}}};
const KernelProgram kEvsmProgram = {kEvsmStages, kFilterableOrder, shadow_layout};
// Of what floats hold, with room for rounding; over the whole range of depths, as 40 is from -1 to 1.
constexpr double kEvsmExponent = 80.0;
const ShadowMapRecipe kEvsmRecipe = filterable_recipe(kEvsmExponent);
constexpr std::array<std::string_view, 5> kEvsmSettings = {"shadow-size", "shadow-bias", "shadow-source", "shadow-blur",
                                                           "shadow-exponent"};

} // namespace

constinit const ShadowKind kShadowEvsm = {
    .name = "evsm",
    .summary = "the most light that mean and variance of exponentials of depth allow (Lauritzen and McCool 2008)",
    .sources = kAllSources,
    .settings = kEvsmSettings,
    .program = &kEvsmProgram,
    .make = [](const ShadowContext& context) { return make_shadow_maps(kEvsmRecipe, context); },
};

} // namespace wavepath
