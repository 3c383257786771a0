// Screen-space ambient occlusion (Mittring 2007).
#include <array>

#include "host/integrators/occlusion/kinds.h"
#include "host/integrators/occlusion/screen_space.h"
#include "kernels/occlusion/ssao.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kStages = {{{kScreenOcclusionStage, wavepath_ssao_spv}}};
constexpr std::array<std::size_t, 1> kOrder = {0};
const KernelProgram kProgram = {kStages, kOrder, screen_space_layout};

} // namespace

constinit const OcclusionKind kOcclusionSsao = {
    .name = "ssao",
    .summary = "points of a ball behind the depth buffer (SSAO, Mittring 2007)",
    .program = &kProgram,
};

} // namespace wavepath
