// The floor under an asset that catches its shadow.
#pragma once

#include "host/scene/bounds.h"
#include "host/scene/scene.h"

namespace wavepath {

// Appends a matte disc at the lowest point of `bounds`, several times as wide as they are, which fades out towards its
// rim. Its albedo is such that where nothing shades it, it looks as the environment does a little below the horizon, in
// the direction of framing_forward(): so it vanishes before an even backdrop, and what is seen of it is the shadow and
// the light that the asset casts. A surface as any other, for every integrator.
void add_ground(Scene& scene, const Bounds& bounds);

// Fits the albedo to another environment of a scene that add_ground() was the last to add to.
void relight_ground(Scene& scene);

} // namespace wavepath
