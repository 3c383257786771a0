// Horizon-based ambient occlusion (Bavoil, Sainz and Dimitrov 2008).
#include <array>

#include "host/integrators/hybrid/occlusion/kinds.h"
#include "host/integrators/hybrid/occlusion/screen_space.h"
#include "kernels/hybrid/occlusion/hbao.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kHbaoStages = {{{kScreenOcclusionStage, wavepath_hbao_spv}}};
const KernelProgram kHbaoProgram = {kHbaoStages, kOnlyStage, screen_space_layout};
constexpr std::array<std::string_view, 1> kHbaoSettings = {"ao-bias"};

} // namespace

constinit const OcclusionKind kOcclusionHbao = {
    .name = "hbao",
    .summary = "horizons over the tangent plane (HBAO, Bavoil et al. 2008)",
    .settings = kHbaoSettings,
    .program = &kHbaoProgram,
};

} // namespace wavepath
