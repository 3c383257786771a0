// Screen-space ambient occlusion (Mittring 2007).
#include <array>

#include "host/integrators/hybrid/occlusion/kinds.h"
#include "host/integrators/hybrid/occlusion/screen_space.h"
#include "kernels/hybrid/occlusion/ssao.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kSsaoStages = {{{kScreenOcclusionStage, wavepath_ssao_spv}}};
const KernelProgram kSsaoProgram = {kSsaoStages, kOnlyStage, screen_space_layout};

} // namespace

constinit const OcclusionKind kOcclusionSsao = {
    .name = "ssao",
    .summary = "points of a ball behind the depth buffer (SSAO, Mittring 2007)",
    .program = &kSsaoProgram,
};

} // namespace wavepath
