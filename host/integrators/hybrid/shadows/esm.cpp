// Exponential shadow maps (Annen et al. 2008).
#include "host/integrators/hybrid/shadows/filterable.h"
#include "host/integrators/hybrid/shadows/kinds.h"
#include "kernels/hybrid/shadows/blur_columns.spv.h"
#include "kernels/hybrid/shadows/esm_rows.spv.h"
#include "kernels/hybrid/shadows/look_up_esm.spv.h"

namespace wavepath {
namespace {

const FilterableStages kEsmStages = {{{"shadow look-up", wavepath_look_up_esm_spv},
                                      {"shadow rows", wavepath_esm_rows_spv},
                                      {"shadow columns", wavepath_blur_columns_spv}}};
const KernelProgram kEsmProgram = {kEsmStages, kFilterableOrder, shadow_layout};
// Of what floats hold, with room for rounding; over the whole range of depths, as 40 is from -1 to 1.
constexpr double kEsmExponent = 80.0;
const ShadowMapRecipe kEsmRecipe = filterable_recipe(kEsmExponent);
constexpr std::array<std::string_view, 5> kEsmSettings = {"shadow-size", "shadow-bias", "shadow-source", "shadow-blur",
                                                          "shadow-exponent"};

} // namespace

constinit const ShadowKind kShadowEsm = {
    .name = "esm",
    .summary = "a map's depths as exponentials, averaged (Annen et al. 2008)",
    .sources = kAllSources,
    .settings = kEsmSettings,
    .program = &kEsmProgram,
    .make = [](const ShadowContext& context) { return make_shadow_maps(kEsmRecipe, context); },
};

} // namespace wavepath
