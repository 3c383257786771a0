// A floor under an asset, which catches its shadow.
#pragma once

#include "host/scene/bounds.h"
#include "host/scene/scene.h"

namespace wavepath {

// Appends a matte disc at the lowest point of `bounds`, several times as wide, which fades out towards its rim. Its
// albedo is chosen so that, unshadowed, it looks like the environment a little below the horizon in the direction of
// framing_forward(). So it is invisible before an even backdrop, except for the shadow and the light that the asset
// casts. It is an ordinary surface for every integrator.
void add_ground(Scene& scene, const Bounds& bounds);

// Adapts the albedo to another environment. add_ground() must have been the last to add to the scene.
void relight_ground(Scene& scene);

} // namespace wavepath
