#include "host/bench/frames.h"

#include "host/base/clock.h"

namespace wavepath {

WarmLoop make_loop(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings) {
  WarmLoop warm;
  warm.view = view;
  warm.kernels = std::make_unique<KernelCompiler>(device);
  // All paths that fit in a wave, and no estimates: the same work every time.
  const LoopPolicy policy{.estimates = Estimates::none,
                          .fixed_wave = choose_slots(device.info(), scene.features, settings)};
  warm.loop = std::make_unique<RenderLoop>(device, scene, view, settings, *warm.kernels, RenderHooks{}, policy);
  warm.compile_seconds = warm.loop->get_ready();
  return warm;
}

RenderTime time_render(WarmLoop& warm, std::uint32_t spp) {
  RenderPlan settings = warm.loop->settings();
  settings.first_sample = 0;
  settings.last_sample = spp;
  warm.loop->restart(warm.view, settings);
  const Clock::time_point start = Clock::now();
  while (warm.loop->step()) {
  }
  warm.loop->drain();
  RenderTime time;
  time.seconds = seconds_since(start);
  time.stages = warm.loop->totals().stages;
  time.rays = warm.loop->totals().rays;
  return time;
}

std::uint32_t choose_spp(WarmLoop& warm) {
  constexpr double kLongEnough = 0.33; // seconds
  std::uint32_t spp = 1;
  while (spp < 64 && time_render(warm, spp).seconds < kLongEnough) spp *= 2;
  return spp;
}

} // namespace wavepath
