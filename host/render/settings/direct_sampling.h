// How the vertices of a path look for light: how many shadow rays go to lights, and how many to a sky of one colour.
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

// Derived in one place from the settings and the scene; kernels, queues, memory and training read it.
struct DirectSampling {
  std::uint32_t lights = 1; // light samples where a path first scatters: 1 to gpu::kMostLightSamples
  // Directions in which every vertex looks for a sky of one colour, the path's own among them. Where they are learned,
  // those of the first vertex: the others become fewer as light samples do.
  std::uint32_t sky = 1;
  bool kernels_see_sky = false; // kernels have shadow rays to the sky: for `sky`, or for a pilot's number

  // Queues of shadow rays: one for each light sample, and one for each direction that is not the path's own.
  std::uint32_t queues() const { return lights + sky - 1; }
  // Directions that leave light samples their queues: together they have gpu::kMostLightSamples.
  std::uint32_t sky_that_fits() const;
  // Shadow rays of a vertex. `learned`: the sky's directions.
  std::uint32_t light_rays_at(std::uint32_t bounce) const;
  std::uint32_t sky_rays_at(std::uint32_t bounce, bool learned) const;
  // Those of a path with so many vertices, at most.
  std::uint32_t most_rays(std::uint32_t vertices) const;
};

// One of each for integrators that do not support the settings. `scene`: its kFeature bits.
DirectSampling direct_sampling(const RenderPlan& settings, gpu::Feature scene);

// The settings with the most directions that a pilot may still choose: what memory is planned for.
RenderPlan with_most_sky(RenderPlan settings, gpu::Feature scene);

// Whether shadow rays may look for the sky besides paths (kernels/path/sky.glsl): it has one colour, and paths alone
// look for it. Not where panes let shadow rays pass, since a path does not know how much of the sky is left to it
// behind one.
bool may_sample_sky(const RenderPlan& settings, gpu::Feature scene);
// Whether a pilot that tries it costs little more than its paths: lights have no tree, of which it would have to train,
// and materials no layers, whose kernels take long to compile.
bool tries_sky_cheaply(gpu::Feature scene);

} // namespace wavepath
