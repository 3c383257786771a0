// Variance soft shadow maps (Yang, Dong, Feng and Seidel 2010).
#include <array>

#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/shadow_maps.h"
#include "kernels/hybrid/shadows/look_up_vssm.spv.h"
#include "kernels/hybrid/shadows/sat_columns.spv.h"
#include "kernels/hybrid/shadows/sat_rows.spv.h"

namespace wavepath {
namespace {

enum VssmStage : std::size_t { kVssmLookUp, kRows, kColumns, kVssmStageCount };
const std::array<KernelCode, kVssmStageCount> kVssmStages = {{{"shadow look-up", wavepath_look_up_vssm_spv},
                                                              {"shadow rows", wavepath_sat_rows_spv},
                                                              {"shadow columns", wavepath_sat_columns_spv}}};
constexpr std::array<std::size_t, kVssmStageCount> kVssmOrder = {kVssmLookUp, kRows, kColumns};
const KernelProgram kVssmProgram = {kVssmStages, kVssmOrder, shadow_layout};
constexpr std::array<MapPass, 2> kPasses = {{{kRows, MapPass::Items::lines}, {kColumns, MapPass::Items::lines}}};
const ShadowMapRecipe kVssmRecipe = {
    .scratch_bytes = [](const RenderPlan&) { return std::uint64_t{4 * sizeof(gpu::uint)}; }, .passes = kPasses};
constexpr std::array<std::string_view, 4> kVssmSettings = {"shadow-size", "shadow-bias", "shadow-source",
                                                           "shadow-taps"};

} // namespace

constinit const ShadowKind kShadowVssm = {
    .name = "vssm",
    .summary = "soft shadows from mean and variance of depths over boxes of any size (Yang et al. 2010)",
    .sources = kAreaSources,
    .settings = kVssmSettings,
    .program = &kVssmProgram,
    .maps = &kVssmRecipe,
    .make = make_shadow_maps,
};

} // namespace wavepath
