// What of the packed scene a hit is on: the node of the file that shows it, and the triangle there.
#pragma once

#include <cstdint>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"
#include "kernels/base/frame_types.h"

namespace wavepath {

// The node of the file that shows what was hit; kNoIndex where nothing was hit, or no node shows it.
std::uint32_t node_of(const PackedScene& scene, const gpu::Hit& hit);

// The same of a triangle of a mesh that is shown once.
std::uint32_t node_of_once(const PackedScene& scene, std::uint32_t triangle);

// Index into PackedScene::materials. `hit` is none of nothing.
std::uint32_t material_of(const PackedScene& scene, const gpu::Hit& hit);

// Unit normal of the triangle itself, in world space, on its front side (counter-clockwise), where the shutter opens.
// Not a number where single precision has left the triangle no area. `hit` is none of nothing.
glm::dvec3 geometric_normal(const PackedScene& scene, const gpu::Hit& hit);

// Position in the device's world space, where the shutter opens. `hit` is none of nothing.
glm::dvec3 hit_position(const PackedScene& scene, const gpu::Hit& hit);

// TEXCOORD_0; zero where no texture of the scene reads coordinates, which are not packed then. `hit` is none of
// nothing.
glm::dvec2 texture_coordinates(const PackedScene& scene, const gpu::Hit& hit);

} // namespace wavepath
