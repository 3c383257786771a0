// Small pictures that a render makes beside its own, as pilots.
#pragma once

#include "host/film/film.h"
#include "host/render/render.h"

namespace wavepath {

// Settings of a pilot: those of the render for a picture of the same shape, with at most `longest_side` pixels a side
// and `samples` samples a pixel. It is no part of another render and has no other limit. AOVs stay, because kernels
// without them would have to be compiled. It is not adaptive: two pilots would choose different levels, and their paths
// could not be compared. So the kernels of the render serve it if nothing else is changed. Pixels that reuse each
// other's paths are as close to each other as in the whole picture.
RenderPlan pilot_settings(const RenderPlan& settings, std::uint32_t longest_side, std::uint32_t samples);

// Renders all samples. Throws Error if `progress` stops it before.
RenderResult render_pilot(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                          const ProgressCallback& progress, KernelCompiler& kernels, SceneOnDevice& shared);

// Sum of the light of a picture over pixels and channels, and the estimated variance of that sum.
struct PictureLight {
  double sum = 0.0, variance = 0.0;
};
PictureLight light_of(const Film& film);

} // namespace wavepath
