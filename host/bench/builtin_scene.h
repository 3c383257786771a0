// The scene that `wavepath bench` measures if none is named.
#pragma once

#include "host/scene/scene.h"

namespace wavepath {

// A Cornell box of 3 m (Goral et al. 1984) with a lamp, a glossy and a rippled ball, 64 k triangles in all: coherent
// and incoherent rays, direct and indirect light. Its camera looks into it.
Scene builtin_scene();

} // namespace wavepath
