// Finds the planes of a scene that are large enough to receive shadows.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"

namespace wavepath {

// The points p with dot(normal, p) + offset = 0, in the device's world space.
struct ReceiverPlane {
  glm::dvec3 normal{0.0}; // unit length; either side
  double offset = 0.0;
  double area = 0.0; // total area of the triangles that lie in it
};

// Distance in metres up to which a corner lies in a plane.
double plane_tolerance(const PackedScene& scene);

// The largest planes, at most kMostPlanes, each with at least kLeastFraction of the area of all triangles.
inline constexpr std::size_t kMostPlanes = 16;
inline constexpr double kLeastFraction = 0.02;
std::vector<ReceiverPlane> receiver_planes(const PackedScene& scene);
// Reason why a technique whose shadows fall only on these planes has nothing to do; empty if it has.
std::string no_receiver_planes(const PackedScene& scene);

} // namespace wavepath
