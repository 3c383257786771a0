// Shadow volumes (Crow 1977) in a stencil buffer, counted in front of visible surfaces (z-pass) or behind them
// (z-fail).
#pragma once

#include <memory>

#include "host/integrators/hybrid/shadows/technique.h"

namespace wavepath {

extern const KernelProgram kVolumeProgram; // the look-up, the same for both ways of counting

enum class VolumeCount { in_front, behind };

std::unique_ptr<ShadowTechnique> make_shadow_volumes(const ShadowContext& context, VolumeCount count);

} // namespace wavepath
