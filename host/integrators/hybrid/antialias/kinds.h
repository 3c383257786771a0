// The techniques there are, one constant a file of this folder.
#pragma once

#include "host/integrators/hybrid/antialias/technique.h"

namespace wavepath {

extern const AntialiasKind kAntialiasFilter;      // filter.cpp
extern const AntialiasKind kAntialiasNone;        // none.cpp
extern const AntialiasKind kAntialiasSupersample; // supersample.cpp
extern const AntialiasKind kAntialiasMsaa;        // msaa.cpp
extern const AntialiasKind kAntialiasFxaa;        // fxaa.cpp
extern const AntialiasKind kAntialiasSmaa;        // smaa.cpp
extern const AntialiasKind kAntialiasTaa;         // taa.cpp

} // namespace wavepath
