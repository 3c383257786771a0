#include "host/render/depth_cut.h"

#include <algorithm>
#include <cmath>

namespace wavepath {

DepthCut measure_depth_cut(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
                           KernelCompiler& kernels) {
  constexpr std::uint32_t kLongestSide = 64, kSamples = 16;
  RenderSettings small = settings;
  const std::uint32_t longest = std::max(settings.width, settings.height);
  small.width = std::max(1u, settings.width * std::min(kLongestSide, longest) / longest);
  small.height = std::max(1u, settings.height * std::min(kLongestSide, longest) / longest);
  small.first_sample = 0, small.last_sample = kSamples, small.sample_total = 0;
  small.time_limit = small.target_error = 0.0;
  small.guide = false;    // the pilot would take longer
  small.adaptive = false; // pilots of two depths choose other levels, and the paths would no longer be the same
  const Picture cut = render(device, scene, view, small, RenderHooks{}, kernels).picture;
  small.max_depth = settings.max_depth * 4 + 16;
  const Picture deep = render(device, scene, view, small, RenderHooks{}, kernels).picture;

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
