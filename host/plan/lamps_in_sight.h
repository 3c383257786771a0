// How much of the lamps' light reaches what the picture shows by straight lines: a few rays on the host, no pilot.
#pragma once

#include <optional>

#include "host/scene/pack/packed_scene.h"
#include "host/scene/staging/view.h"

namespace wavepath {

// Fraction of straight lines from what the picture shows to lamps (suns and environments are none) that nothing blocks,
// lamps by their power; empty if there is no lamp or nothing is shown. About 200 rays, as many again for lamps: less
// than a millisecond. Depends on scene and view alone.
std::optional<double> lamps_in_sight(const PackedScene& scene, const View& view);

} // namespace wavepath
