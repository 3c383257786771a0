// Tangents for normal maps where a file gives none, as MikkTSpace makes them (Mikkelsen, Simulation of Wrinkled
// Surfaces Revisited, 2008).
#pragma once

#include <vector>

#include "host/scene/material.h"
#include "host/scene/scene.h"

namespace wavepath {

// Fills mesh.tangents, and mesh.layer_tangents where the material needs them, by the coordinates that its textures are
// read with: KHR_texture_transform included. What a file gives as TANGENT, by contrast, stays as it is, as the
// specification has it, and serves all textures.
void add_tangents(Mesh& mesh, const Material& material);

// Fills `into`, an array of the mesh that is empty, from positions, normals (flat if empty) and `uvs` (as many as
// positions, or empty: arbitrary tangents). Vertices where triangles of both handednesses meet are split, so vertex and
// index arrays may change; `uvs` may be one of the mesh's own arrays.
void generate_tangents(Mesh& mesh, const std::vector<glm::vec2>& uvs, std::vector<glm::vec4>& into);
inline void generate_tangents(Mesh& mesh, const std::vector<glm::vec2>& uvs) {
  generate_tangents(mesh, uvs, mesh.tangents);
}

} // namespace wavepath
