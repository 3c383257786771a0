// Finds the planes of a scene that are mirrors.
#pragma once

#include <cstddef>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"

namespace wavepath {

// The points p with dot(normal, p) + offset = 0, in the device's world space.
struct MirrorPlane {
  glm::dvec3 normal{0.0}; // unit length; either side
  double offset = 0.0;
  double area = 0.0;              // of the mirrors that lie in it
  glm::dvec3 low{0.0}, high{0.0}; // box around these mirrors
};

// The planes with the most mirrors in them, of the first 256 planes of the scene: at most kMostMirrors, the largest
// first. A mirror is a flat triangle whose material reflects at least `threshold` head-on, as its factors tell:
// textures can only lower that.
std::vector<MirrorPlane> mirror_planes(const PackedScene& scene, double threshold);

// True if all surfaces that may be mirrors, flat or not, lie in one plane, so that no mirror shows another one.
bool lie_in_one_plane(const PackedScene& scene, double threshold);

// True if a point of the box around the mirrors in a plane lies farther than `tolerance` in front of `plane`.
bool reaches_in_front(const MirrorPlane& mirrors, const MirrorPlane& plane, double tolerance);

// True if surfaces of the material are mirrors somewhere, as its factors tell.
bool is_mirror(const gpu::Material& material, double threshold);

// Distance in metres up to which a point lies in a plane.
double mirror_tolerance(const PackedScene& scene);

} // namespace wavepath
