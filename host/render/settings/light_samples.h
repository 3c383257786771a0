// How many light samples a path takes where it first scatters, and how many directions look for the sky.
#pragma once

#include <cstdint>

#include "host/render/settings/render_plan.h"

namespace wavepath {

// What auto means under an environment map. Which part of it shines where a path first scatters decides most of the
// noise there, and a shadow ray costs little beside the rest of the path: over one sample, time times squared error is
// 0.6 to 0.8 outdoors; with lamps in rooms it is more than 1 (benchmarks/results/NOTES.md).
inline constexpr std::uint32_t kLightSamplesOfMaps = 4;
// The same where a light sample is expensive: materials have layers, or lights a tree to walk.
inline constexpr std::uint32_t kFewLightSamplesOfMaps = 2;

// 1 to gpu::kMostLightSamples; 1 for integrators that do not support the setting. `scene`: its kFeature bits.
std::uint32_t light_samples_of(const RenderPlan& settings, gpu::Feature scene);

// Whether shadow rays may look for the sky besides paths (kernels/path/sky.glsl): it has one colour, and paths alone
// look for it. Not where panes let shadow rays pass, since a path does not know how much of the sky is left to it
// behind one.
bool may_sample_sky(const RenderPlan& settings, gpu::Feature scene);
// Whether a pilot of --sky-samples auto costs little more than its paths: lights have no tree, of which it would have
// to train, and materials no layers, whose kernels take long to compile.
bool tries_sky_cheaply(gpu::Feature scene);
// Directions in which every vertex looks for it, the path's own among them; 1 where it may not be shared. Where they
// are learned, those of the first vertex, as light samples are (gpu::sky_samples_at).
std::uint32_t sky_samples_of(const RenderPlan& settings, gpu::Feature scene);
// As many as leave light samples their queues: together they have gpu::kMostLightSamples.
std::uint32_t sky_samples_that_fit(const RenderPlan& settings, gpu::Feature scene);
// What --sky-samples auto takes where it pays to look and directions are learned: 7, if they fit. 5 take 1.15 of the
// squared error times seconds in Sponza, 8 no less than 7, and 1.04 of that of 5 in HotelRoom
// (benchmarks/results/NOTES.md).
std::uint32_t learned_sky_samples(const RenderPlan& settings, gpu::Feature scene);

// The most that the settings may come to when --sky-samples auto has chosen.
std::uint32_t most_sky_samples_of(const RenderPlan& settings, gpu::Feature scene);

// Queues of shadow rays: one for each light sample, and one for each direction to the sky that is not the path's own.
std::uint32_t shadow_queues(std::uint32_t light_samples, std::uint32_t sky_samples);

} // namespace wavepath
