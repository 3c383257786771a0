// What next-event estimation picks from: emissive triangles, punctual lights and the environment, weighted by power.
#pragma once

#include <cstdint>
#include <span>

#include "host/scene/pack/geometry.h"
#include "host/scene/pack/pack.h"

namespace wavepath {

// Fills packed.lights, environment_probability and the triangles' light_pdf. `object_of`: by instance of
// packed.instances its object; of a scene without instances, empty with one object. `environment_integral`: of its
// luminance over the sphere. A triangle's light_pdf is its power density over the total power: the same for every
// instance that shows it, however it is scaled, because each of them is picked in proportion to its own world area. A
// constant environment is sampled only with kDirectNee: for MIS, BSDF sampling alone does better. With kDirectBsdf
// nothing is packed; punctual lights then light nothing, and a warning says so. Throws Error if the lights do not fit
// into 2^26 entries.
void pack_lights(Scene& scene, std::span<const Object> objects, std::span<const std::uint32_t> object_of,
                 double environment_integral, std::uint32_t direct, PackedScene& packed);

} // namespace wavepath
