// Builds one Mesh from a glTF mesh: triangulated, morphed and, if it has a skin, posed in world space.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "host/scene/gltf/material.h"

namespace wavepath::gltf {

// One use of a mesh. Uses that agree in all three give the same Mesh.
struct MeshUse {
  int mesh = 0;
  std::vector<double> weights; // weights of its morph targets; missing ones are 0
  int skin = -1;

  auto operator<=>(const MeshUse&) const = default;
};

// True if read_mesh() reads anything from the primitive, and so needs its material.
bool has_triangles(const tinygltf::Primitive& primitive);

// `world`: matrices of all nodes. Converts the materials that it needs. Throws Error.
Mesh read_mesh(Document& document, Scene& scene, MaterialMap& map, const MeshUse& use,
               const std::vector<glm::dmat4>& world);

} // namespace wavepath::gltf
