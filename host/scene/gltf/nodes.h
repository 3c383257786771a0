// The node hierarchy: which nodes a scene holds and where they are.
#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/gltf/document.h"

namespace wavepath::gltf {

// Index of what `request` (name or index) means among `names`; throws Error that lists them. `kind`: "scene",
// "animation".
std::size_t choose(const Document& document, const std::string& kind, const std::vector<std::string>& names,
                   const std::string& request);

// Nodes of the scene that `request` names (empty: the default scene, else the first one, else every root node), parents
// before children. Throws Error.
std::vector<int> scene_nodes(const Document& document, const std::string& request);

// World matrices of all nodes, composed in double. Throws Error if a node has two parents or contains itself.
std::vector<glm::dmat4> world_matrices(const Document& document);

} // namespace wavepath::gltf
