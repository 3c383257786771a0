// Shadow volumes in a stencil buffer, counted in front of what is seen or behind it.
#pragma once

#include <memory>

#include "host/integrators/hybrid/shadows/technique.h"

namespace wavepath {

extern const KernelProgram kVolumeProgram; // looks up, however volumes are counted

enum class VolumeCount { in_front, behind };

std::unique_ptr<ShadowTechnique> make_shadow_volumes(const ShadowContext& context, VolumeCount count);

} // namespace wavepath
