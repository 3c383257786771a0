// Tells interiors from objects, and finds a place to stand in one.
#pragma once

#include <optional>

#include "host/scene/framing.h"

namespace wavepath {

// An interior is what surrounds its middle: from most points in its box, rays nearly all round meet surfaces that face
// them. (Inside an object they meet its back.) Glass and what is blended count as openings. The camera then stands at
// eye height where it has the longest free way before it, and looks along it. Depends on the scene alone.
std::optional<Standpoint> find_standpoint(const Scene& scene, const Bounds& bounds);

} // namespace wavepath
