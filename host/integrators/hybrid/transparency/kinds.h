// The techniques of transparency there are, one constant a file of this folder.
#pragma once

#include "host/integrators/hybrid/transparency/technique.h"

namespace wavepath {

extern const TransparencyKind kTransparencySorted;     // sorted.cpp
extern const TransparencyKind kTransparencyPeel;       // peel.cpp
extern const TransparencyKind kTransparencyWeighted;   // weighted.cpp
extern const TransparencyKind kTransparencyScreendoor; // screendoor.cpp
extern const TransparencyKind kTransparencyStochastic; // stochastic.cpp
extern const TransparencyKind kTransparencyRefractive; // refractive.cpp

} // namespace wavepath
