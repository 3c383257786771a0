// The techniques of transparency there are, in the order of --transparency. Each is a constant in a file of its own in
// this folder: kTransparencySorted in sorted.cpp.
#pragma once

#include "host/integrators/hybrid/transparency/technique.h"
#include "host/render/settings/registry.h"

namespace wavepath {

WAVEPATH_ROWS(TransparencyKind, kTransparencyKinds, kTransparencySorted, kTransparencyPeel, kTransparencyWeighted,
              kTransparencyScreendoor, kTransparencyStochastic, kTransparencyRefractive);

} // namespace wavepath
