// Blinn's model (1977).
#include <array>

#include "host/integrators/hybrid/shading/kinds.h"
#include "kernels/hybrid/shading/blinn_phong.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kBlinnPhongStages = {{{"local shading", wavepath_blinn_phong_spv}}};
const KernelProgram kBlinnPhongProgram = {kBlinnPhongStages, kOnlyStage, local_layout};

} // namespace

constinit const ShadingKind kShadingBlinnPhong = {
    .name = "blinn-phong",
    .summary = "Blinn's model (1977), scaled to keep energy",
    .settings = kShadingSettings,
    .program = &kBlinnPhongProgram,
};

} // namespace wavepath
