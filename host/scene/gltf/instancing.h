// EXT_mesh_gpu_instancing: one node, many places.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "host/scene/gltf/document.h"

namespace wavepath::gltf {

// Where the mesh of `node` stands: once at `world`, or wherever the extension puts it below that. Throws Error.
std::vector<glm::dmat4> instance_matrices(Document& document, const tinygltf::Node& node, const glm::dmat4& world);

} // namespace wavepath::gltf
