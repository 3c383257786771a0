// Phong's model (1975).
#include <array>

#include "host/integrators/hybrid/shading/kinds.h"
#include "kernels/hybrid/shading/phong.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kPhongStages = {{{"local shading", wavepath_phong_spv}}};
const KernelProgram kPhongProgram = {kPhongStages, kOnlyStage, local_layout};

} // namespace

constinit const ShadingKind kShadingPhong = {
    .name = "phong",
    .summary = "Phong's model (1975), scaled to keep energy",
    .settings = kShadingSettings,
    .program = &kPhongProgram,
};

} // namespace wavepath
