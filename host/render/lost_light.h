// Light that paths from the camera cannot find: of lamps and suns, which they cannot meet, through thick smooth glass
// and off mirrors, which shadow rays cannot cross.
#pragma once

#include <optional>
#include <string>

#include "host/render/render.h"

namespace wavepath {

struct LostLight {
  double fraction = 0.0;       // of all light, missing
  double standard_error = 0.0; // of that
  // The two integrators disagree on light that both find (agreement.h): then one of them is wrong, and the difference
  // is no loss.
  bool disagrees = false;
};

// Whether some surface reflects or refracts into a single direction, as mirrors and glass do.
bool has_smooth_surface(const PackedScene& scene);

// Whether the scene has both such lights and a surface of a single direction.
bool may_lose_light(const PackedScene& scene);

// What lamps and suns outside bodies that scatter do not light in them, because their smooth walls refract: a sentence,
// empty if there is no such body or no such light.
std::string unlit_bodies(const PackedScene& scene);

// Renders a pilot with `settings`, and one by an integrator that has light paths; the difference of their light
// is what the first one lacks. Nothing where no light can be lost, or the integrator has light paths itself. `progress`
// may end it: then, where the other integrator cannot render the scene, and where the device fails, it throws Error.
std::optional<LostLight> measure_lost_light(Device& device, const PackedScene& scene, const View& view,
                                            const RenderPlan& settings, KernelCompiler& kernels, SceneOnDevice& shared,
                                            const ProgressCallback& progress = {});

} // namespace wavepath
