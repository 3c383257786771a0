// Bodies: closed volumes that light passes through (KHR_materials_volume). Finds those that overlap, their priorities,
// and those that hold the eye or a lamp. See kernels/path/bodies.glsl.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"
#include "host/scene/scene.h"

namespace wavepath {

// True if a closed surface of the material is a body.
bool is_body(const Material& material);

// True if the boxes of any two bodies intersect. False for scenes of 65,535 materials or more.
bool bodies_overlap(const Scene& scene);

// Priorities for each material of the scene: 1 and up, 0 if it is no body. Where bodies overlap, the one of higher
// priority counts: that with the smaller box, or the later material if equal. So a bubble in glass is a bubble, and
// water that reaches into the wall of its glass is water there, from both sides.
std::vector<std::uint32_t> body_priorities(const Scene& scene);

// Materials of the bodies that hold a point of the device's world, by falling priority. Counts surfaces along three
// rays; for a body with holes, two of the three decide.
std::vector<std::uint32_t> bodies_at(const PackedScene& scene, const glm::dvec3& point);

// True if the box of a body holds a lamp or a part of one. Suns and skies are outside of all bodies.
bool lamps_in_bodies(const PackedScene& scene);

} // namespace wavepath
