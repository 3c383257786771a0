// Tangents for normal maps where a file gives none, as MikkTSpace makes them (Mikkelsen, Simulation of Wrinkled
// Surfaces Revisited, 2008).
#pragma once

#include <vector>

#include "host/scene/scene.h"

namespace wavepath {

// Fills mesh.tangents from positions, normals (flat if empty) and `uvs` (as many as positions, or empty: arbitrary
// tangents). Vertices where triangles of both handednesses meet are split, so vertex and index arrays may change; `uvs`
// may be one of the mesh's own arrays.
void generate_tangents(Mesh& mesh, const std::vector<glm::vec2>& uvs);

} // namespace wavepath
