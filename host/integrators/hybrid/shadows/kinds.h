// The techniques there are, one constant a file of this folder.
#pragma once

#include "host/integrators/hybrid/shadows/technique.h"

namespace wavepath {

extern const ShadowKind kShadowMap;        // map.cpp
extern const ShadowKind kShadowMapId;      // map_id.cpp
extern const ShadowKind kShadowPcf;        // pcf.cpp
extern const ShadowKind kShadowPcss;       // pcss.cpp
extern const ShadowKind kShadowVsm;        // vsm.cpp
extern const ShadowKind kShadowEsm;        // esm.cpp
extern const ShadowKind kShadowEvsm;       // evsm.cpp
extern const ShadowKind kShadowMoment;     // moment.cpp
extern const ShadowKind kShadowVssm;       // vssm.cpp
extern const ShadowKind kShadowAverage;    // average.cpp
extern const ShadowKind kShadowLeak;       // leak.cpp
extern const ShadowKind kShadowCascades;   // cascades.cpp
extern const ShadowKind kShadowSdsm;       // sdsm.cpp
extern const ShadowKind kShadowLispsm;     // lispsm.cpp
extern const ShadowKind kShadowTsm;        // tsm.cpp
extern const ShadowKind kShadowPsm;        // psm.cpp
extern const ShadowKind kShadowCube;       // cube.cpp
extern const ShadowKind kShadowParaboloid; // paraboloid.cpp
extern const ShadowKind kShadowVirtual;    // virtual.cpp
extern const ShadowKind kShadowIzb;        // izb.cpp
extern const ShadowKind kShadowPlanar;     // planar.cpp
extern const ShadowKind kShadowLightmap;   // lightmap.cpp
extern const ShadowKind kShadowProjected;  // projected.cpp
extern const ShadowKind kShadowZpass;      // zpass.cpp
extern const ShadowKind kShadowZfail;      // zfail.cpp

} // namespace wavepath
