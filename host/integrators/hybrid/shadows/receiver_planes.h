// The planes of a scene that are large enough for shadows on them to matter.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"

namespace wavepath {

// Points p with dot(normal, p) + offset = 0, device world.
struct ReceiverPlane {
  glm::dvec3 normal{0.0}; // of unit length, on either side
  double offset = 0.0;
  double area = 0.0; // of all triangles that lie in it
};

// Metres from a plane up to which a corner lies in it.
double plane_tolerance(const PackedScene& scene);

// At most kMostPlanes, the largest first, whose triangles together are at least kLeastFraction of the area of all.
inline constexpr std::size_t kMostPlanes = 16;
inline constexpr double kLeastFraction = 0.02;
std::vector<ReceiverPlane> receiver_planes(const PackedScene& scene);
// Why a technique whose shadows fall on these alone has nothing to do; empty if it has.
std::string no_receiver_planes(const PackedScene& scene);

} // namespace wavepath
