// EXT_mesh_gpu_instancing: several instances of a node's mesh.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "host/base/warnings.h"
#include "host/scene/gltf/document.h"
#include "host/scene/gltf/nodes.h"

namespace wavepath::gltf {

// World matrices of the instances of a node's mesh: `world`, or with the extension `world` times each of its
// transforms, `scales` as in world_matrices(). There are as many as any attribute has elements, also one of the file's
// own that changes nothing. Throws Error.
std::vector<glm::dmat4> instance_matrices(Document& document, Warnings& warnings, const tinygltf::Node& node,
                                          const glm::dmat4& world, Scales scales);

} // namespace wavepath::gltf
