// Phong's model (1975).
#include <array>

#include "host/integrators/shading/kinds.h"
#include "kernels/shading/phong.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kStages = {{{"local shading", wavepath_phong_spv}}};
constexpr std::array<std::size_t, 1> kOrder = {0};
const KernelProgram kProgram = {kStages, kOrder, local_layout};

} // namespace

constinit const ShadingKind kShadingPhong = {
    .name = "phong",
    .summary = "Phong's model (1975), scaled to keep energy",
    .settings = kShadingSettings,
    .program = &kProgram,
};

} // namespace wavepath
