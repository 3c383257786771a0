// Estimates the fraction of the lamps' light that reaches visible surfaces directly, by a few rays on the host.
#pragma once

#include <optional>

#include "host/scene/pack/packed_scene.h"
#include "host/scene/staging/view.h"

namespace wavepath {

// Fraction, 0 to 1, of unblocked straight lines between points that the picture shows and points on lamps. Lamps are
// picked in proportion to their power; suns and environments do not count. Empty if the scene has no lamp or the
// picture shows nothing. Traces about 400 rays in less than a millisecond. Depends on the scene and the view alone.
std::optional<double> lamps_in_sight(const PackedScene& scene, const View& view);

} // namespace wavepath
