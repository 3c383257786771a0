// Ground-truth ambient occlusion (Jimenez et al. 2016).
#include <array>

#include "host/integrators/hybrid/occlusion/kinds.h"
#include "host/integrators/hybrid/occlusion/screen_space.h"
#include "kernels/hybrid/occlusion/gtao.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kGtaoStages = {{{kScreenOcclusionStage, wavepath_gtao_spv}}};
const KernelProgram kGtaoProgram = {kGtaoStages, kOnlyStage, screen_space_layout};
constexpr std::array<std::string_view, 1> kGtaoSettings = {"ao-thinness"};

} // namespace

constinit const OcclusionKind kOcclusionGtao = {
    .name = "gtao",
    .summary = "cosine-weighted visibility between two horizons a slice (GTAO, Jimenez et al. 2016)",
    .settings = kGtaoSettings,
    .program = &kGtaoProgram,
};

} // namespace wavepath
