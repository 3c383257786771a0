// Lambert's cosine law (1760), without highlights.
#include <array>

#include "host/integrators/shading/kinds.h"
#include "kernels/shading/lambert.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kStages = {{{"local shading", wavepath_lambert_spv}}};
constexpr std::array<std::size_t, 1> kOrder = {0};
const KernelProgram kProgram = {kStages, kOrder, local_layout};

} // namespace

constinit const ShadingKind kShadingLambert = {
    .name = "lambert",
    .summary = "Lambert's cosine law",
    .settings = std::span(kShadingSettings).first(kSettingsOfDull),
    .program = &kProgram,
};

} // namespace wavepath
