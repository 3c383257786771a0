#include "host/render/depth_cut.h"

#include <algorithm>
#include <cmath>

#include "host/render/pilot_picture.h"

namespace wavepath {

DepthCut measure_depth_cut(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                           KernelCompiler& kernels, SceneOnDevice& shared, const ProgressCallback& progress) {
  constexpr std::uint32_t kLongestSide = 64, kSamples = 16;
  RenderPlan small = pilot_settings(settings, kLongestSide, kSamples);
  small.guide = false; // the same picture, without the seconds of training a field for each of the two
  small.training.found = shared.light_probabilities;
  const Picture cut = render_pilot(device, scene, view, small, progress, kernels, shared).picture;
  small.training.found = shared.light_probabilities; // both with the same, wherever they were trained
  small.max_depth = settings.max_depth * 4 + 16;
  const Picture deep = render_pilot(device, scene, view, small, progress, kernels, shared).picture;

  double total = 0.0, missing = 0.0, squares = 0.0;
  const std::size_t pixels = cut.channels[0].values.size();
  for (std::size_t i = 0; i < pixels; ++i) {
    double here = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      total += deep.channels[c].values[i];
      here += double{deep.channels[c].values[i]} - double{cut.channels[c].values[i]};
    }
    missing += here;
    squares += here * here;
  }
  const double n = static_cast<double>(pixels);
  const double spread = std::sqrt(std::max(0.0, squares - missing * missing / n));
  return {total > 0.0 ? missing / total : 0.0, total > 0.0 ? spread / total : 0.0, small.max_depth};
}

} // namespace wavepath
