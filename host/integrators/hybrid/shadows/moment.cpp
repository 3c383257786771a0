// Moment shadow maps (Peters and Klein 2015).
#include "host/integrators/hybrid/shadows/filterable.h"
#include "host/integrators/hybrid/shadows/kinds.h"
#include "kernels/hybrid/shadows/look_up_moment.spv.h"
#include "kernels/hybrid/shadows/moment_columns.spv.h"
#include "kernels/hybrid/shadows/moment_rows.spv.h"

namespace wavepath {
namespace {

const FilterableStages kMomentStages = {{{"shadow look-up", wavepath_look_up_moment_spv},
                                         {"shadow rows", wavepath_moment_rows_spv},
                                         {"shadow columns", wavepath_moment_columns_spv}}};
const KernelProgram kMomentProgram = {kMomentStages, kFilterableOrder, shadow_layout};
const ShadowMapRecipe kMomentRecipe = filterable_recipe();
constexpr std::array<std::string_view, 5> kMomentSettings = {"shadow-size", "shadow-bias", "shadow-source",
                                                             "shadow-blur", "shadow-bits"};

} // namespace

constinit const ShadowKind kShadowMoment = {
    .name = "moment",
    .summary = "the most light that four moments of a map's depths allow (Peters and Klein 2015)",
    .sources = kAllSources,
    .settings = kMomentSettings,
    .program = &kMomentProgram,
    .make = [](const ShadowContext& context) { return make_shadow_maps(kMomentRecipe, context); },
};

} // namespace wavepath
