#include "host/render/pilot_picture.h"

#include <algorithm>

#include "host/base/error.h"
#include "host/render/settings/adaptivity.h"
#include "host/render/settings/path_reuse.h"
#include "host/render/settings/probing.h"
#include "kernels/base/error_probes.h"

namespace wavepath {

RenderPlan pilot_settings(const RenderPlan& settings, std::uint32_t longest_side, std::uint32_t samples) {
  RenderPlan small = settings;
  small.crop.reset(); // a part is rendered as the whole picture is
  const std::uint32_t longest = std::max(settings.width, settings.height), side = std::min(longest_side, longest);
  small.width = std::max(1u, settings.width * side / longest);
  small.height = std::max(1u, settings.height * side / longest);
  small.first_sample = 0, small.last_sample = samples, small.sample_total = 0;
  small.time_limit = small.target_error = 0.0;
  small.adaptive = kAdaptiveOff;
  small.training.paths = 0;
  small.training.guide_iterations = std::min(small.training.guide_iterations, kGuideIterations);
  if (reuses_paths(settings)) small.quad_scale *= static_cast<double>(small.width) / settings.width;
  small.kernels.has_probes |= has_error_probes(settings);
  if (is_adaptive(settings)) small.kernels.added |= gpu::kFeatureAdaptive;
  return small;
}

RenderResult render_pilot(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                          const ProgressCallback& progress, KernelCompiler& kernels, SceneOnDevice& shared) {
  RenderResult result = render(device, scene, view, settings, RenderHooks{progress}, kernels, &shared);
  if (result.stop == StopReason::interrupted) throw Error("a pilot", "was interrupted", "let it end");
  return result;
}

PictureLight light_of(const Film& film) {
  PictureLight light;
  for (std::size_t i = 0; i < std::size_t{film.width} * film.height; ++i) {
    const PixelStatistics pixel = statistics(film, i);
    for (int c = 0; c < 3; ++c) light.sum += pixel.mean[c], light.variance += pixel.variance[c];
  }
  if (film.quads) light.variance *= gpu::kQuadPixels; // upper bound: the four pixels of a quad may have equal errors
  return light;
}

} // namespace wavepath
