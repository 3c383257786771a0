// Measures light that paths from the camera cannot find. It comes from lamps and suns without extent, which paths
// cannot hit, by way of smooth thick glass or mirrors, which shadow rays do not cross.
#pragma once

#include <optional>
#include <string>

#include "host/render/render.h"

namespace wavepath {

struct LostLight {
  double fraction = 0.0;       // missing light over all light
  double standard_error = 0.0; // standard error of `fraction`
  // True if the two integrators disagree on light that both find (agreement.h). Then one of them is wrong, and
  // `fraction` is meaningless.
  bool disagrees = false;
};

// True if some surface reflects or refracts into a single direction, as mirrors and smooth glass do.
bool has_smooth_surface(const PackedScene& scene);

// True if the scene has lights without extent and a surface of a single direction.
bool may_lose_light(const PackedScene& scene);

// A warning about bodies that scatter light inside: lamps and suns outside do not light them if their smooth walls
// refract. Empty if there is no such body or light.
std::string unlit_bodies(const PackedScene& scene);

// Renders a pilot with `settings` and one by an integrator with light paths; the difference is the light that the first
// lacks. Empty if no light can be lost, or if the integrator itself has light paths. `progress` may stop it. Throws
// Error if it is stopped, if the other integrator cannot render the scene, or if the device fails.
std::optional<LostLight> measure_lost_light(Device& device, const PackedScene& scene, const View& view,
                                            const RenderPlan& settings, KernelCompiler& kernels, SceneOnDevice& shared,
                                            const ProgressCallback& progress = {});

} // namespace wavepath
