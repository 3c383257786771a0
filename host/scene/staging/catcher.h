// The shadow catcher: the surface whose light a photograph shows already (--catcher).
#pragma once

#include <string>

#include "host/scene/scene.h"

namespace wavepath {

// Gives the meshes of a node, by its name or index, and of all nodes below it materials of their own, from
// Scene::first_catcher on. `node` is "ground": does nothing, since catch_ground() follows. Throws UsageError if no such
// node shows triangles.
void add_catcher(Scene& scene, const std::string& node);

// After add_ground(), if it is the catcher.
void catch_ground(Scene& scene);

// Warns if neither lamps nor an environment light the scene: nothing then casts a shadow on the catcher.
void warn_of_unlit_catcher(Scene& scene);

} // namespace wavepath
