// The techniques of a diffuse bounce there are, in the order of --bounce. Each is a constant in a file of its own in
// this folder: kBounceTraced in traced.cpp.
#pragma once

#include "host/integrators/hybrid/reflections/technique.h"
#include "host/render/settings/registry.h"

namespace wavepath {

WAVEPATH_ROWS(ReflectionKind, kBounceKinds, kBounceTraced, kBounceCones);

} // namespace wavepath
