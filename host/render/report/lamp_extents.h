// Extents of soft lamps (--sun-angle, --lamp-radius), as bias, stats and `wavepath info` tell them.
#pragma once

#include <nlohmann/json.hpp>

#include "host/scene/pack/packed_scene.h"

namespace wavepath {

// 0: there are none.
struct LampExtents {
  double sun_degrees = 0.0; // that directional lights are across
  double radius = 0.0;      // metres, of the spheres of point and spot lights
};

LampExtents lamp_extents(const PackedScene& scene);

// Null where no lamp has an extent.
nlohmann::ordered_json lamp_extents_json(const PackedScene& scene);

} // namespace wavepath
