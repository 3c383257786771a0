#include "host/plan/memory.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "host/picture/filter/denoise.h"
#include "host/render/settings/adaptivity.h"
#include "host/render/settings/denoising.h"
#include "host/render/settings/direct_sampling.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/workspace/light_training.h"
#include "host/render/workspace/workspace.h"

namespace wavepath {
namespace {

std::vector<MemoryItem> plan_path(const RenderPlan& settings, gpu::Feature features) {
  const IntegratorKind& kind = *settings.integrator;
  std::vector<MemoryItem> named;
  if (kind.slot_items) named = kind.slot_items(features, settings);
  std::vector<MemoryItem> items = {{"state and queues", kind.bytes_per_slot(features, settings) - total_bytes(named)}};
  items.insert(items.end(), named.begin(), named.end());
  return items;
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
  std::vector<MemoryItem> items = {
      {"film", film, MemoryLocation::both},
      {"film of splats", shape.bytes() - film - shape.group_bytes(), MemoryLocation::both},
      {"film of light groups", shape.group_bytes(), MemoryLocation::both},
      {"order of samples", is_adaptive(settings) ? shape.entries() * sizeof(std::uint32_t) : 0, MemoryLocation::both},
      {"frames", pixels * kind.bytes_per_pixel(settings)},
      {"learned lights", trains_lights(training, settings) ? kind.light_training_bytes : 0},
      {"learned sky", trains_sky(training, with_most_sky(settings, features)) ? kind.sky_training_bytes : 0},
      {"picture", pixels * sizeof(float) * (4 + 3 * (settings.aovs.size() + shape.groups)), MemoryLocation::host},
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
