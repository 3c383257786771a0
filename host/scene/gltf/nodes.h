// The node hierarchy: which nodes a scene holds and where they are.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/gltf/document.h"

namespace wavepath::gltf {

// Index of what `request` (name or index) means among `names`; throws Error that lists them. `kind`: "scene",
// "animation".
std::size_t choose(const Document& document, const std::string& kind, const std::vector<std::string>& names,
                   const std::string& request);

// The scene that `request` names; empty: the default scene, else the first one, else none. Throws Error.
std::optional<std::size_t> scene_index(const Document& document, const std::string& request);

// Nodes of the scene that `request` names (empty: the default scene, else the first one, else every root node), parents
// before children. Throws Error.
std::vector<int> scene_nodes(const Document& document, const std::string& request);

// The node above each node; kNoIndex where it has none. Throws Error if a node has two.
std::vector<std::uint32_t> node_parents(const Document& document);

// World matrices of all nodes, composed in double. A node's matrix whose last row is 0,0,0,1 but for kAffineRounding is
// taken as affine. `scales`: as authored, or their signs alone, zero as +1, which tells the directions that a scale of
// zero leaves open. Throws Error if a node has two parents or contains itself.
enum class Scales { authored, signs };
inline constexpr double kAffineRounding = 1e-5;
glm::dvec3 take_scale(const glm::dvec3& scale, Scales scales);
std::vector<glm::dmat4> world_matrices(const Document& document, Scales scales = Scales::authored);

// The matrix of one node, relative to the node above it.
glm::dmat4 local_matrix(const tinygltf::Node& node, Scales scales);

inline constexpr const char* kNodeVisibility = "KHR_node_visibility";
// True if that extension of the node itself hides it.
bool is_hidden(const tinygltf::Node& node);
void set_hidden(tinygltf::Node& node, bool hides);
// For each node: true if KHR_node_visibility hides it or a node above it. Nodes must form no cycle, which
// world_matrices() has checked.
std::vector<bool> hidden_nodes(const Document& document);

} // namespace wavepath::gltf
