// Skinning: joint matrices of a skin and their blend at a vertex.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "host/base/warnings.h"
#include "host/scene/gltf/accessor.h"

namespace wavepath::gltf {

// Joints and weights of the vertices of a primitive; empty without a skin.
struct Skin {
  std::vector<glm::dmat4> joints;         // world from bind pose
  std::vector<Elements> indices, weights; // JOINTS_0, JOINTS_1, ... and WEIGHTS_*, of equal number

  bool present() const { return !joints.empty(); }
};

// The skin as `primitive`, of so many vertices, uses it, or none for -1. Throws Error if it is incomplete.
Skin open_skin(Document& document, Warnings& warnings, const tinygltf::Primitive& primitive, int skin,
               const std::vector<glm::dmat4>& world, std::size_t vertex_count, const Decoded& decoded);

// World from object for one vertex. Counts weights that are not finite, which weigh nothing. Throws Error if a joint
// index is out of range.
glm::dmat4 blend(const Document& document, const Skin& skin, std::size_t vertex, std::size_t& not_finite);

} // namespace wavepath::gltf
