// Numbers of light samples and of sky directions at the vertices of a path.
#pragma once

#include <cstdint>

#include "host/render/settings/render_plan.h"

namespace wavepath {

// Light samples that `auto` means under an environment map. Most noise at the first vertex depends on which part of the
// map it samples, and a shadow ray is cheap compared with the rest of the path. Over one light sample, four have 0.6x
// to 0.8x time times squared error outdoors, but more than 1x with lamps in rooms (benchmarks/results/NOTES.md).
inline constexpr std::uint32_t kLightSamplesOfMaps = 4;
// The same number where light samples are expensive: materials have layers, or the lights have a tree.
inline constexpr std::uint32_t kFewLightSamplesOfMaps = 2;

// Light samples of a path where it first scatters: 1 to gpu::kMostLightSamples; 1 for integrators that do not support
// the setting. `scene`: kFeature bits of the scene, here and below.
std::uint32_t light_samples_of(const RenderPlan& settings, gpu::Feature scene);

// True if shadow rays may look for the sky besides paths (kernels/path/sky.glsl). The sky must have one colour, so that
// no light sample is drawn from it. Thin panes rule it out: shadow rays pass them, and a path behind one does not know
// how much of the sky is left to it.
bool may_sample_sky(const RenderPlan& settings, gpu::Feature scene);
// True if a pilot for --sky-samples auto costs little more than its paths. A light tree would have to be trained first;
// kernels of layered materials take long to compile.
bool tries_sky_cheaply(gpu::Feature scene);
// Directions in which a vertex looks for the sky, the path's own included; 1 where shadow rays may not. If directions
// are trained, this is the number at the first vertex; later vertices have fewer (gpu::sky_samples_at).
std::uint32_t sky_samples_of(const RenderPlan& settings, gpu::Feature scene);
// Largest number of sky directions: light samples and sky share gpu::kMostLightSamples queues.
std::uint32_t sky_samples_that_fit(const RenderPlan& settings, gpu::Feature scene);
// Number of directions that --sky-samples auto takes if several pay and they are trained: 7, or fewer if they do not
// fit. 5 have 1.15x squared error times seconds in Sponza, and 8 have no less than 7; 7 have 1.04x that of 5 in
// HotelRoom (benchmarks/results/NOTES.md).
std::uint32_t learned_sky_samples(const RenderPlan& settings, gpu::Feature scene);

// Largest number of directions that may come of these settings once --sky-samples auto has been decided.
std::uint32_t most_sky_samples_of(const RenderPlan& settings, gpu::Feature scene);

// Number of queues of shadow rays: one for each light sample, and one for each sky direction except the path's own.
std::uint32_t shadow_queues(std::uint32_t light_samples, std::uint32_t sky_samples);

} // namespace wavepath
