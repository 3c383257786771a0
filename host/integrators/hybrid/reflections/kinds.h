// The techniques of reflections there are, in the order of --reflections. Each is a constant in a file of its own in
// this folder: kReflectionTraced in traced.cpp.
#pragma once

#include "host/integrators/hybrid/reflections/technique.h"
#include "host/render/settings/registry.h"

namespace wavepath {

WAVEPATH_ROWS(ReflectionKind, kReflectionKinds, kReflectionTraced, kReflectionPlanar, kReflectionStencil,
              kReflectionCube, kReflectionSphere, kReflectionProbe, kReflectionSsr);

} // namespace wavepath
