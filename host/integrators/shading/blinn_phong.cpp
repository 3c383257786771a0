// Blinn's model (1977).
#include <array>

#include "host/integrators/shading/kinds.h"
#include "kernels/shading/blinn_phong.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kStages = {{{"local shading", wavepath_blinn_phong_spv}}};
constexpr std::array<std::size_t, 1> kOrder = {0};
const KernelProgram kProgram = {kStages, kOrder, local_layout};

} // namespace

constinit const ShadingKind kShadingBlinnPhong = {
    .name = "blinn-phong",
    .summary = "Blinn's model (1977), scaled to keep energy",
    .settings = kShadingSettings,
    .program = &kProgram,
};

} // namespace wavepath
