// Points that stand for a lamp with an extent.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "host/integrators/hybrid/shadows/source.h"

namespace wavepath {

// Points of a rectangle, disc or sphere that share its area evenly (Hammersley 1960).
std::vector<glm::dvec3> lamp_points(const ShadowSource& source, std::uint32_t count);

} // namespace wavepath
