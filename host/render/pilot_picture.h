// Pilots: small pictures that a render makes beside its own, to judge itself by.
#pragma once

#include "host/film/film.h"
#include "host/render/render.h"

namespace wavepath {

// The same settings for a picture of the same shape, `longest_side` pixels at most and `samples` samples a pixel: no
// part, stopped by nothing else. AOVs stay, because kernels without them would be others. Not adaptive: pilots of two
// such pictures would choose other levels, and their paths would no longer be comparable. Kernels of the render serve
// it where nothing else is changed. Pixels that share paths are as close to each other as in the whole picture.
RenderPlan pilot_settings(const RenderPlan& settings, std::uint32_t longest_side, std::uint32_t samples);

// Renders all samples. Throws Error if `progress` ends it before.
RenderResult render_pilot(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                          const ProgressCallback& progress, KernelCompiler& kernels, SceneOnDevice& shared);

// All light of a picture, over its pixels and channels, and an estimate of the variance of that.
struct PictureLight {
  double sum = 0.0, variance = 0.0;
};
PictureLight light_of(const Film& film);

} // namespace wavepath
