// --sky-samples auto: decides in how many directions a vertex looks for a sky of one colour.
#pragma once

#include <optional>

#include "host/gpu/device_class.h"
#include "host/plan/decision.h"
#include "host/plan/pilot_runner.h"

namespace wavepath {

// `cost`: of the best number of untrained directions, relative to one direction.
struct SkyChoice : PilotOutcome {
  // Directions a vertex; 0 = no pilot was made, since the render is short or no sky of one colour can be sampled.
  std::uint32_t samples = 0;
  bool trains = false; // the render starts with training where the sky is visible (learned_sky.glsl)
};

// True if the render is long enough for pilots, whatever the scene, so that compiling kernels for them can begin before
// the scene is known (KernelCapacity::shared_sky).
bool may_try_sky(const RenderPlan& settings, DeviceClass device);

// Renders one pilot with one direction a vertex and one with four, and chooses the number with the least squared error
// times work. The model has two terms each: the light of the sky contributes a part of the squared error that falls as
// 1 / directions, and every direction costs the same work. Several directions pay where few paths reach the sky: 0.31x
// to 0.45x time to equal error in Sponza with four, but 1.3x to 2.1x with a helmet or a dragon in the open. If several
// pay and light selection is trained, the directions are trained as well. Work is counted, never timed. No pilot is
// made if a number was given, or if the render has less than 64 times the paths of both pilots or 20 times the cost of
// compiling for them.
SkyChoice choose_sky_samples(PilotRunner& pilots, const RenderPlan& settings);

// Number of directions where several pay and they are trained: 7, if they fit. 5 take 1.15x the squared error times
// seconds in Sponza, 8 no less than 7, and 1.04x that of 5 in HotelRoom (benchmarks/results/NOTES.md).
std::uint32_t learned_sky_samples(const RenderPlan& settings, gpu::Feature scene);

// Replaces `auto` by a number where several pay. No decision if a number was given. `pilots`: null if none are to be
// made.
std::optional<Decision> decide_sky_samples(RenderPlan& settings, const PackedScene& scene, DeviceClass device,
                                           PilotRunner* pilots);

} // namespace wavepath
