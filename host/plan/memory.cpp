#include "host/plan/memory.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "host/picture/filter/denoise.h"
#include "host/render/settings/adaptivity.h"
#include "host/render/settings/denoising.h"
#include "host/render/settings/direct_sampling.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/pass_names.h"
#include "host/render/workspace/light_training.h"
#include "host/render/workspace/workspace.h"
#include "kernels/film/film_types.h"
#include "kernels/path/path_types.h"

namespace wavepath {
namespace {

// Samples of a pixel on each of two or three nodes, and materials, before they become values (host/passes).
constexpr std::uint64_t kCryptomatteBytesPerPixel = 256;

std::vector<MemoryItem> plan_path(const RenderPlan& settings, gpu::Feature features) {
  const IntegratorKind& kind = *settings.integrator;
  std::vector<MemoryItem> named;
  if (kind.slot_items) named = kind.slot_items(features, settings);
  std::vector<MemoryItem> items = {{"state and queues", kind.bytes_per_slot(features, settings) - total_bytes(named)}};
  items.insert(items.end(), named.begin(), named.end());
  return items;
}

// Values of a pixel that the AOV adds to the picture: at most three but for Cryptomatte's two layers of six pairs.
std::uint64_t values_of(const std::string& aov) { return aov == "cryptomatte" ? 24 : 3; }

// What the host holds of the passes' rays, as they come from the device and as they are visited. On the device they
// take no more than the samples, whose memory is free by then.
std::uint64_t pass_bytes(const RenderPlan& settings, std::uint64_t pixels) {
  if (std::ranges::none_of(settings.aovs, is_pass)) return 0;
  constexpr std::uint64_t kOfRay = 2 * (sizeof(gpu::Ray) + sizeof(gpu::Hit) + sizeof(gpu::PathAovs));
  const bool counts = std::ranges::count(settings.aovs, "cryptomatte") > 0;
  return kMostPassRays * kOfRay + (counts ? pixels * kCryptomatteBytesPerPixel : 0);
}

} // namespace

std::uint64_t total_bytes(const std::vector<MemoryItem>& items) {
  std::uint64_t sum = 0;
  for (const MemoryItem& item : items) sum += item.bytes;
  return sum;
}

MemoryPlan plan_memory(const RenderPlan& settings, const ScenePlan& scene, gpu::Feature features) {
  const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
  const IntegratorKind& kind = *settings.integrator;
  const FilmShape shape = film_shape(settings);
  FilmShape without_splats = shape;
  without_splats.splats = false, without_splats.groups = 0;
  const std::uint64_t film = without_splats.bytes();
  const TrainingScene training(scene, features);
  std::uint64_t values = 4 + 3 * shape.groups;
  for (const std::string& aov : settings.aovs) values += values_of(aov);
  std::vector<MemoryItem> items = {
      {"film", film, MemoryLocation::both},
      {"film of splats", shape.bytes() - film - shape.group_bytes(), MemoryLocation::both},
      {"film of light groups", shape.group_bytes(), MemoryLocation::both},
      {"order of samples", is_adaptive(settings) ? shape.entries() * sizeof(std::uint32_t) : 0, MemoryLocation::both},
      {"frames", pixels * kind.bytes_per_pixel(settings)},
      {"learned lights", trains_lights(training, settings) ? kind.light_training_bytes : 0},
      {"learned sky", trains_sky(training, with_most_sky(settings, features)) ? kind.sky_training_bytes : 0},
      {"picture", pixels * sizeof(float) * values, MemoryLocation::host},
      {"rays of passes", pass_bytes(settings, pixels), MemoryLocation::host},
      {"filter", denoises_film(settings) ? pixels * kDenoiseBytesPerPixel : 0, MemoryLocation::host}};
  if (kind.items)
    for (const MemoryItem& item : kind.items(settings, scene, features)) items.push_back(item);
  std::erase_if(items, [](const MemoryItem& item) { return item.bytes == 0; });
  std::vector<MemoryItem> path = plan_path(settings, features);
  std::erase_if(path, [](const MemoryItem& item) { return item.bytes == 0; });
  return {std::move(items), std::move(path)};
}

MemoryCheck::MemoryCheck(std::string file, const ScenePlan& scene, gpu::Feature features, DeviceInfo device,
                         std::uint64_t available)
    : file_(std::move(file)), scene_(scene), features_(features), device_(std::move(device)), available_(available) {}

std::uint64_t MemoryCheck::bytes(const RenderPlan& settings) const {
  const bool shared = device_.type == "cpu" || device_.type == "integrated"; // the device's memory is the host's
  const MemoryPlan plan = plan_memory(settings, scene_, features_);
  std::uint64_t sum = (shared ? 2 : 1) * scene_.total();
  for (const MemoryItem& item : plan.render) {
    if (item.location != MemoryLocation::device) sum += item.bytes;
    if (item.location != MemoryLocation::host && shared) sum += item.bytes;
  }
  return sum + (shared ? choose_slots(device_, features_, settings) * total_bytes(plan.path) : 0);
}

void MemoryCheck::require(const RenderPlan& settings) const {
  require_memory(file_, fmt::format("rendering it at {}x{}", settings.width, settings.height), bytes(settings),
                 "use a smaller --size, fewer --aov or a simpler scene", available_);
}

} // namespace wavepath
