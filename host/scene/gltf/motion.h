// Motion between two poses of a scene.
#pragma once

#include "host/scene/scene.h"

namespace wavepath::gltf {

// Gives the meshes of `scene` that stand elsewhere in `end`, the same scene at a later moment, their motion. A mesh
// that is shown more than once gets a copy for each instance that moves. Throws Error if the two do not show the same
// instances.
void add_motion(Scene& scene, const Scene& end);

} // namespace wavepath::gltf
