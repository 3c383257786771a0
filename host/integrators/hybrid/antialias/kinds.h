// The techniques of anti-aliasing there are, in the order of --antialias. Each is a constant in a file of its own in
// this folder: kAntialiasFilter in filter.cpp.
#pragma once

#include "host/integrators/hybrid/antialias/technique.h"
#include "host/render/settings/registry.h"

namespace wavepath {

WAVEPATH_ROWS(AntialiasKind, kAntialiasKinds, kAntialiasFilter, kAntialiasNone, kAntialiasSupersample, kAntialiasFxaa,
              kAntialiasSmaa, kAntialiasTaa, kAntialiasMsaa, kAntialiasCsaa, kAntialiasUpscale, kAntialiasBeam,
              kAntialiasCone);

} // namespace wavepath
