// Volumes of nodes: `extras` with a member "volume", which names a NanoVDB file and its coefficients.
#pragma once

#include <optional>
#include <vector>

#include <glm/glm.hpp>
#include <nlohmann/json_fwd.hpp>

#include "host/scene/gltf/document.h"
#include "host/scene/scene.h"

namespace wavepath::gltf {

// The volumes of all nodes of a document, in their order; `root`: its JSON. Throws Error if one has values that no
// volume can have.
std::vector<NodeVolume> find_volumes(Document& document, const nlohmann::json& root);

// The volume of these nodes, placed by their matrices; its grids are read when one first needs them. `is_replaced`:
// none is read, since the caller has one of its own. Throws Error; so it does if there are two.
std::optional<Volume> place_volume(Document& document, Warnings& warnings, const std::vector<int>& nodes,
                                   const std::vector<bool>& hidden, const std::vector<glm::dmat4>& world,
                                   bool is_replaced);

} // namespace wavepath::gltf
