#include "host/bench/ray_replay.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <limits>

#include "host/integrators/path/path_replay.h"
#include "kernels/frame_types.h"
#include "kernels/path/path_types.h"

namespace wavepath {
namespace {

gpu::ShadowRay as_shadow_ray(const gpu::Ray& ray) {
  return {ray.origin, ray.slot, ray.direction, gpu::kFar, glm::vec3(1.0f), 0};
}

} // namespace

RaySets RayReplay::capture() {
  const FilmBand& band = tracer_.bands_.front();
  const std::uint32_t pixels = std::min(band.pixel_count, tracer_.slots());
  tracer_.reset();
  gpu::Wave wave{band.first_pixel, pixels, 0, 1, 0, band.first_pixel};
  const KernelSet& kernels = tracer_.kernels_.best(tracer_.config_);
  Commands commands(tracer_.device_);
  commands.bind(*band.bindings);
  for (const Stage stage : {kGenerate, kAdvance, kExtend, kShade}) {
    if (stage == kAdvance)
      commands.dispatch(kernels[kAdvance], 1, &wave);
    else
      commands.dispatch(kernels[stage], groups_for(pixels), &wave);
    commands.barrier();
  }
  commands.submit_and_wait();

  const gpu::Queues queues = tracer_.counters();
  const std::uint64_t second_queue = std::uint64_t{tracer_.slots()} * sizeof(gpu::Ray);
  RaySets rays;
  rays.camera = download<gpu::Ray>(tracer_.paths_.rays, pixels);
  rays.bounce = download<gpu::Ray>(tracer_.paths_.rays, queues.ray_count[1], second_queue);
  rays.shadow = download<gpu::ShadowRay>(tracer_.paths_.shadow_rays, queues.shadow_count);
  constexpr std::size_t kFewest = 4096; // that say anything about speed
  if (rays.shadow.size() < kFewest && rays.shadow.size() < rays.bounce.size()) {
    rays.shadow.clear();
    for (const gpu::Ray& ray : rays.bounce) rays.shadow.push_back(as_shadow_ray(ray));
  }
  return rays;
}

// Timed by the device where its queue has timestamps.
double RayReplay::time(Stage stage, std::size_t count) {
  const FilmBand& band = tracer_.bands_.front();
  const gpu::Wave wave{band.first_pixel, band.pixel_count, 0, 1, 0, band.first_pixel};
  const KernelSet& kernels = tracer_.kernels_.best(tracer_.config_);
  Commands commands(tracer_.device_, 1);
  commands.bind(*band.bindings);
  commands.dispatch(kernels[stage], groups_for(count), &wave);
  const auto start = std::chrono::steady_clock::now();
  commands.submit_and_wait();
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double device = commands.times().empty() ? 0.0 : commands.times().front().seconds;
  return device > 0.0 ? device : wall;
}

double RayReplay::extend(std::span<const gpu::Ray> rays) {
  gpu::Queues queues{};
  queues.ray_count[0] = static_cast<std::uint32_t>(rays.size());
  tracer_.paths_.queues.write(&queues, sizeof(queues));
  tracer_.paths_.rays.write(rays.data(), rays.size_bytes());
  return time(kExtend, rays.size());
}

std::vector<gpu::Hit> RayReplay::hits(std::size_t count) const { return download<gpu::Hit>(tracer_.paths_.hits, count); }

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
  queues.shadow_count = static_cast<std::uint32_t>(rays.size());
  tracer_.paths_.queues.write(&queues, sizeof(queues));
  tracer_.paths_.shadow_rays.write(rays.data(), rays.size_bytes());
  tracer_.paths_.states.fill_zero();
  return time(kConnect, rays.size());
}

std::vector<bool> RayReplay::blocked(std::span<const gpu::ShadowRay> rays) const {
  const auto paths = download<gpu::PathState>(tracer_.paths_.states, tracer_.slots());
  std::vector<bool> result;
  for (const gpu::ShadowRay& ray : rays) result.push_back(paths[ray.slot].radiance == glm::vec3(0.0f));
  return result;
}

} // namespace wavepath
