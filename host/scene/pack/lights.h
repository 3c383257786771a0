// The lights that next-event estimation samples: emissive triangles, punctual lights and the environment, weighted by
// power.
#pragma once

#include <cstdint>
#include <span>

#include "host/scene/pack/geometry.h"
#include "host/scene/pack/packed_scene.h"
#include "host/scene/scene.h"

namespace wavepath {

// Largest number of local lights without a tree, with kLightsAuto.
inline constexpr std::size_t kFewLights = 8;
// Lights count as many if they stand in many cells whose width is this fraction of the scene's radius; or in many small
// cells, as lamps over one table on a large floor do. With 60 lamps within 5 m, on a floor of 28 m, selection by power
// took 3.6x squared error times seconds of learned lights, and the tree 2.5x (generated scene 8, benchmarks/regret.py).
inline constexpr double kPlace = 1.0 / 8.0, kManyLocations = 8.0, kSmallPlace = 1.0 / 32.0, kManySmallPlaces = 16.0;

// Fills packed.lights, lamp_sources, environment_probability, Triangle::light and Instance::first_light.
// `object_of`: object of each instance; empty for a scene of one object without instances. `environment_integral`: of
// the environment's luminance over the sphere. `selection`: a kLights constant; unless it is by power, local lights get
// a tree, with kLightsAuto only if there are more than kFewLights of them.
// Lights form groups: local ones (triangles, then lamps), directional ones, the environment. A group is picked in
// proportion to its power, but never less than half as often as with equal probabilities; within a group, lights are
// picked by power. A constant environment is sampled only with kDirectNee: with MIS, BSDF sampling alone has less
// noise. With kDirectBsdf nothing is packed; punctual lights then have no effect, and a warning says so. Throws Error
// if there are more than 2^26 lights.
void pack_lights(Scene& scene, std::span<const Object> objects, std::span<const std::uint32_t> object_of,
                 double environment_integral, std::uint32_t direct, std::uint32_t selection, PackedScene& packed);

} // namespace wavepath
