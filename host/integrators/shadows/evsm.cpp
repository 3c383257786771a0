// Exponential variance shadow maps (Lauritzen and McCool 2008).
#include "host/integrators/shadows/filterable.h"
#include "host/integrators/shadows/kinds.h"
#include "kernels/shadows/blur_columns.spv.h"
#include "kernels/shadows/evsm_rows.spv.h"
#include "kernels/shadows/look_up_evsm.spv.h"

namespace wavepath {
namespace {

const FilterableStages kStages = {{{"shadow look-up", wavepath_look_up_evsm_spv},
                                   {"shadow rows", wavepath_evsm_rows_spv},
                                   {"shadow columns", wavepath_blur_columns_spv}}};
const KernelProgram kProgram = {kStages, kFilterableOrder, shadow_layout};
// Of what floats hold, with room for rounding; over the whole range of depths, as 40 is from -1 to 1.
constexpr double kExponent = 80.0;
const ShadowMapRecipe kRecipe = filterable_recipe(kExponent);
constexpr std::array<std::string_view, 5> kSettings = {"shadow-size", "shadow-bias", "shadow-source", "shadow-blur",
                                                       "shadow-exponent"};

} // namespace

constinit const ShadowKind kShadowEvsm = {
    .name = "evsm",
    .summary = "the most light that mean and variance of exponentials of depth allow (Lauritzen and McCool 2008)",
    .sources = kAllSources,
    .settings = kSettings,
    .program = &kProgram,
    .make = [](const ShadowContext& context) { return make_shadow_maps(kRecipe, context); },
};

} // namespace wavepath
