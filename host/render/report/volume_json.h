// The volume of a scene, as `wavepath info` tells it.
#pragma once

#include <nlohmann/json.hpp>

#include "host/scene/volume.h"

namespace wavepath {

// Its file, its grids (density first), its box in metres and its coefficients in 1/m.
nlohmann::ordered_json volume_json(const Volume& volume);

} // namespace wavepath
