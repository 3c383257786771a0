// Bodies: closed volumes that light passes through (KHR_materials_volume). Which of them overlap, which counts where
// they do, and which hold the eye or a lamp. See kernels/path/bodies.glsl.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"
#include "host/scene/scene.h"

namespace wavepath {

// Whether light may be in a body of the material.
bool is_body(const Material& material);

// Whether the boxes of any two bodies of the scene meet. False for scenes of 65535 materials and more.
bool bodies_overlap(const Scene& scene);

// By material of the scene, 0 for those that are no body: 1 and up. Of bodies that overlap, the one of the higher
// priority counts: that in the smaller box (ties: the later material), so that a bubble in glass is a bubble, and water
// that reaches into the wall of its glass is water there, from both sides.
std::vector<std::uint32_t> body_priorities(const Scene& scene);

// Materials of the bodies that hold a point of the device's world, by falling priority; by counting surfaces along
// three rays. A body with holes holds what two of them say.
std::vector<std::uint32_t> bodies_at(const PackedScene& scene, const glm::dvec3& point);

// Whether the box of a body of the device's world holds a lamp, or a part of one. Suns and skies are outside all
// bodies.
bool lamps_in_bodies(const PackedScene& scene);

} // namespace wavepath
