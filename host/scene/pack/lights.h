// The lights that next-event estimation samples: emissive triangles, punctual lights and the environment, weighted by
// power.
#pragma once

#include <cstdint>
#include <span>

#include "host/scene/pack/geometry.h"
#include "host/scene/pack/packed_scene.h"
#include "host/scene/scene.h"

namespace wavepath {

// Fills packed.lights, environment_probability and the triangles' light_pdf. `object_of`: by instance of
// packed.instances its object; of a scene without instances, empty with one object. `environment_integral`: of its
// luminance over the sphere. A triangle's light_pdf is its power density over the total power: the same for every
// instance of it, however scaled, because each is picked in proportion to its own world area. A constant environment is
// sampled only with kDirectNee: with MIS, BSDF sampling alone has less noise. With kDirectBsdf nothing is packed;
// punctual lights then have no effect, and a warning says so. Throws Error if the lights do not fit into 2^26 entries.
void pack_lights(Scene& scene, std::span<const Object> objects, std::span<const std::uint32_t> object_of,
                 double environment_integral, std::uint32_t direct, PackedScene& packed);

} // namespace wavepath
