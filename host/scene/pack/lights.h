// The lights that next-event estimation samples: emissive triangles, punctual lights and the environment, weighted by
// power.
#pragma once

#include <cstdint>
#include <span>

#include "host/scene/pack/geometry.h"
#include "host/scene/pack/packed_scene.h"
#include "host/scene/scene.h"

namespace wavepath {

// Fills packed.lights, environment_probability, Triangle::light and Instance::first_light. `object_of`: by instance of
// packed.instances its object; of a scene without instances, empty with one object. `environment_integral`: of its
// luminance over the sphere. Lights stand in groups: local ones (triangles, then lamps), directional ones, the
// environment. A group gets its fraction of the power, but never less than half of an equal fraction of the picks;
// within a group lights go by power. A constant environment is sampled only with kDirectNee: with MIS, BSDF sampling
// alone has less noise. With kDirectBsdf nothing is packed; punctual lights then have no effect, and a warning says so.
// Throws Error if the lights do not fit into 2^26 entries. `selection`: a kLights constant; unless it is by power, the
// local lights get a tree, with kLightsAuto only if there are more than kFewLights of them.
inline constexpr std::size_t kFewLights = 8;
// Many places, of a width in proportion to the scene's radius; or many small ones, as those of lamps over one table are
// that stands on a large floor: with 60 lamps within 5 m, on a floor of 28 m, lights by power took 3.6x of the squared
// error times seconds of learned ones, and 2.5x of those by a tree (generated scene 8, benchmarks/regret.py).
inline constexpr double kPlace = 1.0 / 8.0, kManyLocations = 8.0, kSmallPlace = 1.0 / 32.0, kManySmallPlaces = 16.0;
void pack_lights(Scene& scene, std::span<const Object> objects, std::span<const std::uint32_t> object_of,
                 double environment_integral, std::uint32_t direct, std::uint32_t selection, PackedScene& packed);

} // namespace wavepath
