// --reuse auto: decides whether neighbouring pixels reuse each other's paths.
#pragma once

#include <optional>

#include "host/gpu/device_class.h"
#include "host/plan/decision.h"
#include "host/plan/pilot_runner.h"

namespace wavepath {

// `cost`: relative to the render without reuse.
struct ReuseChoice : PilotOutcome {
  bool tried = false; // pilots were made; false if the render is short or cannot reuse paths
  bool pays = false;
  // KernelCapacity::reuse of the render: a short render uses the kernels that were compiled for the pilots
  BearsReuse kernels_bear = BearsReuse::nowhere;
};

// The scenes for which the render is long enough to try reuse, as a value of KernelCapacity::reuse. Compiling kernels
// that support reuse can so begin before the scene is known.
BearsReuse where_to_try_reuse(const RenderPlan& settings, DeviceClass device);

// Renders one pilot with reuse and one without, and compares squared error times work. Reuse pays where light arrives
// by diffuse surfaces: 0.3x of the squared error in a Cornell box. It does not pay where most noise comes from direct
// light, metal or glass. Work is counted, never timed.
ReuseChoice choose_reuse(PilotRunner& pilots, const RenderPlan& settings);

// Replaces `auto` by on or off. Without pilots it stays where some could be made. No decision if a value was given.
std::optional<Decision> decide_reuse(RenderPlan& settings, const PackedScene& scene, DeviceClass device,
                                     PilotRunner* pilots);

} // namespace wavepath
