// Whether a render trains its choice of lights, or of parts of the sky, before its first sample.
#pragma once

#include "host/render/settings/render_plan.h"

namespace wavepath {

struct PackedScene;

// Lights are chosen by fractions that training finds for cells of space.
bool trains_lights(const PackedScene& scene, const RenderPlan& settings);
// Directions to a sky of one colour, besides those of paths, are.
bool trains_one_colour(const PackedScene& scene, const RenderPlan& settings);
// Parts of the sky are, of an environment map or of one colour.
bool trains_sky(const PackedScene& scene, const RenderPlan& settings);
// Any of these.
bool trains_light_selection(const PackedScene& scene, const RenderPlan& settings);

} // namespace wavepath
