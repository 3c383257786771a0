#include "host/bench/ray_replay.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "host/base/clock.h"
#include "host/gpu/warm_up.h"
#include "host/render/settings/traversal.h"
#include "host/scene/pack/hit_surface.h"
#include "kernels/base/frame_types.h"
#include "kernels/base/wave.h"
#include "kernels/path/path_types.h"

namespace wavepath {
namespace {

gpu::ShadowRay as_shadow_ray(const gpu::Ray& ray) {
  return {ray.origin, ray.slot, ray.direction, gpu::kFar, glm::vec3(1.0f), 0};
}

} // namespace

RayReplay::RayReplay(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                     KernelCompiler& kernels, std::shared_ptr<const DeviceScene> uploaded)
    : workspace_(device, scene, choose_slots(device.info(), scene.features, settings), traversal_of(settings),
                 std::move(uploaded)),
      paths_(workspace_, kernels) {
  workspace_.change(view, settings);
  paths_.change(settings, kAllPathStages, 0);
  paths_.get_ready();
}

gpu::Wave RayReplay::first_wave() const {
  const FilmBand& band = workspace_.film.bands().front();
  return gpu::even_wave(band.first_pixel, std::min(band.pixel_count, workspace_.slots), 0, 1, band.first_pixel);
}

RaySets RayReplay::capture() {
  const gpu::Wave wave = first_wave();
  const KernelSet& kernels = paths_.kernels();
  Commands commands(workspace_.device);
  commands.bind(paths_.bindings(0));
  commands.dispatch(kernels[kGenerate], groups_for(wave.pixel_count), &wave);
  paths_.extend(commands, kernels, wave, 0);
  paths_.shade(commands, kernels, kernels, wave, 0);
  commands.submit_and_wait();

  const gpu::Queues queues = download<gpu::Queues>(paths_.buffers[kQueues], 1).front();
  const std::uint64_t second_queue = std::uint64_t{workspace_.slots} * sizeof(gpu::Ray);
  RaySets rays;
  rays.camera = download<gpu::Ray>(paths_.buffers[kRays], wave.pixel_count);
  rays.bounce = download<gpu::Ray>(paths_.buffers[kRays], queues.ray_count[1], second_queue);
  rays.shadow = download<gpu::ShadowRay>(paths_.buffers[kShadowRays], queues.shadow_count[0]);
  constexpr std::size_t kFewest = 4096; // that say anything about speed
  if (rays.shadow.size() < kFewest && rays.shadow.size() < rays.bounce.size()) {
    rays.shadow.clear();
    for (const gpu::Ray& ray : rays.bounce) rays.shadow.push_back(as_shadow_ray(ray));
  }
  return rays;
}

// Timed by the device where its queue has timestamps.
double RayReplay::time(PathStage stage, const gpu::Queues& queues, std::size_t count, std::uint32_t bounce) {
  gpu::Wave wave = first_wave();
  wave.bounce = bounce;
  const KernelSet& kernels = paths_.kernels();
  Commands commands(workspace_.device, 1);
  return seconds_when_warm(workspace_.device.info(), [&] {
    commands.restart(1);
    commands.write(paths_.buffers[kQueues], &queues, sizeof(queues));
    commands.bind(paths_.bindings(0));
    commands.dispatch(kernels[stage], groups_for(count), &wave);
    const Clock::time_point start = Clock::now();
    commands.submit_and_wait();
    const double wall = seconds_since(start);
    const double device = commands.times().empty() ? 0.0 : commands.times().front().seconds;
    return device > 0.0 ? device : wall;
  });
}

double RayReplay::extend(std::span<const gpu::Ray> rays, bool from_camera) {
  gpu::Queues queues{};
  queues.ray_count[0] = static_cast<std::uint32_t>(rays.size());
  paths_.buffers[kRays].write(rays.data(), rays.size_bytes());
  return time(kExtend, queues, rays.size(), from_camera ? 0 : 2); // even: in the first queue
}

std::vector<gpu::Hit> RayReplay::hits(std::size_t count) const {
  return download<gpu::Hit>(paths_.buffers[kHits], count);
}

std::vector<float> RayReplay::distances(const PackedScene& scene, std::span<const gpu::Ray> rays) const {
  const std::vector<gpu::Hit> found = hits(rays.size());
  std::vector<float> result(rays.size(), std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const gpu::Hit& hit = found[i];
    if (hit.triangle == gpu::kNone) continue;
    result[i] = static_cast<float>(glm::distance(glm::dvec3(rays[i].origin), hit_position(scene, hit)));
  }
  return result;
}

double RayReplay::connect(std::span<const gpu::ShadowRay> rays) {
  gpu::Queues queues{};
  queues.shadow_count[0] = static_cast<std::uint32_t>(rays.size());
  paths_.buffers[kShadowRays].write(rays.data(), rays.size_bytes());
  paths_.buffers[kStates].fill_zero();
  return time(kConnect, queues, rays.size(), 0);
}

std::vector<bool> RayReplay::blocked(std::span<const gpu::ShadowRay> rays) const {
  const auto paths = download<gpu::PathState>(paths_.buffers[kStates], workspace_.slots);
  std::vector<bool> result;
  for (const gpu::ShadowRay& ray : rays) result.push_back(paths[ray.slot].radiance == glm::vec3(0.0f));
  return result;
}

} // namespace wavepath
