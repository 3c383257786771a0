// Lambert's cosine law (1760), without highlights.
#include <array>

#include "host/integrators/hybrid/shading/kinds.h"
#include "kernels/hybrid/shading/lambert.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kLambertStages = {{{"local shading", wavepath_lambert_spv}}};
const KernelProgram kLambertProgram = {kLambertStages, kOnlyStage, local_layout};

} // namespace

constinit const ShadingKind kShadingLambert = {
    .name = "lambert",
    .summary = "Lambert's cosine law",
    .settings = std::span(kShadingSettings).first(kSettingsOfDull),
    .program = &kLambertProgram,
};

} // namespace wavepath
