// What `wavepath bench` measures when no scene is named.
#pragma once

#include "host/scene/scene.h"

namespace wavepath {

// A Cornell box of 3 m (Goral et al. 1984) with a lamp, a glossy and a rippled ball, 64 k triangles in all: rays that
// agree and rays that do not, direct and bounced light. Looked into by its camera.
Scene builtin_scene();

} // namespace wavepath
