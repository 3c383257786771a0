#include "host/render/pilot_work.h"

#include <algorithm>

#include "host/render/settings/integrator_kind.h"

namespace wavepath {
namespace {

// Paths a second: orders of magnitude.
constexpr double kCpuPaths = 1e5, kGpuPaths = 1e8;

// Paths that take a second at least. Two cores trace 0.4 to 3.4 million in it (Sponza, Cornell box). What a short
// render gains by a pilot, kernels that bear what pilots try take from it again: 0.11 s of 0.4 s of CPU time at 200,000
// paths (benchmarks/regret.py, llvmpipe).
constexpr double kCpuPathsOfASecond = 1e6, kGpuPathsOfASecond = 1e8;

RayCounts minus(RayCounts a, const RayCounts& b) {
  a.camera -= b.camera, a.bounce -= b.bounce, a.shadow -= b.shadow, a.occlusion -= b.occlusion;
  return a;
}

} // namespace

double paths_of(const RenderPlan& settings) {
  const std::uint32_t samples = settings.sample_total > 0 ? settings.sample_total : settings.last_sample;
  return static_cast<double>(settings.width) * settings.height * samples;
}

double expected_paths(const RenderPlan& settings, DeviceClass device) {
  const double asked = paths_of(settings);
  if (!(settings.time_limit > 0.0)) return asked;
  return std::min(asked, settings.time_limit * (is_cpu(device) ? kCpuPaths : kGpuPaths));
}

bool may_make_pilots(const RenderPlan& settings, DeviceClass device) {
  const bool ends_before = settings.time_limit > 0.0 && settings.time_limit < 1.0;
  return !ends_before && paths_of(settings) >= (is_cpu(device) ? kCpuPathsOfASecond : kGpuPathsOfASecond);
}

double steady_work(const RenderPlan& settings, const RenderResult& result, DeviceClass device) {
  const std::size_t count = result.checkpoints.size();
  if (count < 2) return settings.integrator->work(settings, result.rays, device);
  return 2.0 * settings.integrator->work(settings, minus(result.rays, result.checkpoints[count - 2].rays), device);
}

} // namespace wavepath
