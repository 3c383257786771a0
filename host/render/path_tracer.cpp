#include "host/render/path_tracer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>

#include "kernels/accumulate.spv.h"
#include "kernels/advance.spv.h"
#include "kernels/connect.spv.h"
#include "kernels/extend.spv.h"
#include "kernels/generate.spv.h"
#include "kernels/shade.spv.h"

namespace wavepath {
namespace {

struct StageCode {
  const char* name;
  std::span<const std::uint32_t> spirv;
};
const std::array<StageCode, stage_count> kStages = {{{"generate", wavepath_generate_spv},
                                                     {"advance", wavepath_advance_spv},
                                                     {"extend", wavepath_extend_spv},
                                                     {"shade", wavepath_shade_spv},
                                                     {"connect", wavepath_connect_spv},
                                                     {"accumulate", wavepath_accumulate_spv}}};

std::uint32_t groups_for(std::uint64_t count) {
  return static_cast<std::uint32_t>((count + gpu::kWorkgroupSize - 1) / gpu::kWorkgroupSize);
}

// The device's world has `origin` at zero: subtract in double, then round once.
gpu::Frame make_frame(const PackedScene& scene, const View& view, const RenderSettings& settings, std::uint32_t slots) {
  gpu::Frame frame{};
  frame.camera_position = glm::vec3(view.position - scene.origin);
  frame.camera_right = glm::vec3(view.right);
  frame.camera_up = glm::vec3(view.up);
  frame.camera_forward = glm::vec3(view.forward);
  frame.orthographic = view.orthographic ? 1u : 0u;
  frame.width = settings.width;
  frame.height = settings.height;
  frame.max_depth = settings.max_depth;
  frame.seed = settings.seed;
  frame.environment_radiance = scene.environment_radiance;
  frame.environment_probability = scene.environment_probability;
  frame.environment_rotation = glm::vec2(std::cos(scene.environment_rotation), std::sin(scene.environment_rotation));
  frame.environment_width = scene.environment_width;
  frame.environment_height = scene.environment_height;
  frame.light_count = static_cast<std::uint32_t>(scene.lights.size());
  frame.root = scene.root;
  frame.root_is_top = scene.root_is_top ? 1u : 0u;
  frame.sample_total = settings.sample_total > 0 ? settings.sample_total : settings.last_sample;
  frame.slot_count = slots;
  frame.scene_features = scene.features;
  return frame;
}

std::uint32_t compiled_features(const PackedScene& scene, const View& view, const RenderSettings& settings) {
  std::uint32_t features = scene.features;
  if (view.orthographic) features |= gpu::kFeatureOrthographic;
  // Generic kernels leave this out as well: it would need buffers for outputs that nobody asked for.
  if (!settings.specialize) features = gpu::kFeaturesAll & ~gpu::kFeatureAovs;
  if (!settings.aovs.empty()) features |= gpu::kFeatureAovs;
  return (features | settings.added_features) & ~settings.removed_features;
}

std::uint64_t join(const std::uint32_t words[2]) { return std::uint64_t{words[1]} << 32 | words[0]; }

} // namespace

std::uint32_t choose_slots(const DeviceInfo& info, const PackedScene& scene, const RenderSettings& settings) {
  const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
  const std::uint64_t samples = settings.last_sample - settings.first_sample;
  std::uint64_t slots = info.type == "cpu" ? 1u << 17 : 1u << 21;
  if (settings.wave_slots) slots = settings.wave_slots;
  slots = std::min(slots, pixels * samples);
  slots = std::min(slots, info.max_storage_range / std::max(2 * sizeof(gpu::Ray), sizeof(gpu::PathAovs)));
  slots = std::min(slots, info.max_texel_elements / 4);
  slots = std::min<std::uint64_t>(slots, std::uint64_t{info.max_groups} * gpu::kWorkgroupSize);
  slots = std::min(slots, std::max<std::uint64_t>(info.memory_bytes / 8 / bytes_per_slot(scene.features), 1024));
  return static_cast<std::uint32_t>(std::max<std::uint64_t>(slots, 1));
}

RayCounts ray_counts(const gpu::Queues& queues) {
  return {join(queues.camera_rays), join(queues.bounce_rays), join(queues.shadow_rays)};
}

std::uint64_t bytes_per_slot(std::uint32_t features) {
  std::uint64_t bytes = sizeof(gpu::PathState) + 2 * sizeof(gpu::Ray) + sizeof(gpu::Hit) + sizeof(gpu::ShadowRay);
  if (features & gpu::kFeatureVolume) bytes += sizeof(std::uint32_t);
  if (features & gpu::kFeatureAovs) bytes += sizeof(gpu::PathAovs);
  return bytes;
}

PathTracer::PathTracer(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
                       std::uint32_t slots)
    : device_(device),
      frame_(make_frame(scene, view, settings, slots)),
      features_(compiled_features(scene, view, settings)) {
  const auto start = std::chrono::steady_clock::now();
  scene_ = upload_scene(device, scene);
  upload_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  allocate(device, settings);
  create_kernels(device, settings, scene.stack_size);
}

void PathTracer::allocate(Device& device, const RenderSettings& settings) {
  const std::uint64_t slots = frame_.slot_count;
  frame_buffer_ = Buffer(device, sizeof(gpu::Frame));
  frame_buffer_.write(&frame_, sizeof(gpu::Frame));
  paths_ = Buffer(device, slots * sizeof(gpu::PathState));
  path_media_ = Buffer(device, features_ & gpu::kFeatureVolume ? slots * sizeof(std::uint32_t) : 0);
  path_aovs_ = Buffer(device, features_ & gpu::kFeatureAovs ? slots * sizeof(gpu::PathAovs) : 0);
  rays_ = Buffer(device, 2 * slots * sizeof(gpu::Ray));
  hits_ = Buffer(device, slots * sizeof(gpu::Hit));
  shadow_rays_ = Buffer(device, frame_.light_count || settings.room_for_shadow_rays ? slots * sizeof(gpu::ShadowRay) : 0);
  queues_ = Buffer(device, sizeof(gpu::Queues));

  std::vector<Binding> bindings = scene_.bindings();
  using enum BindingKind;
  bindings.insert(bindings.end(), {{gpu::kBindFrame, uniform, &frame_buffer_},
                                   {gpu::kBindPaths, storage, &paths_}, {gpu::kBindPathTexels, texels_rgba32f, &paths_},
                                   {gpu::kBindRays, storage, &rays_},
                                   {gpu::kBindRayTexels, texels_rgba32f, &rays_},
                                   {gpu::kBindHits, storage, &hits_}, {gpu::kBindHitTexels, texels_rgba32ui, &hits_},
                                   {gpu::kBindShadowRays, storage, &shadow_rays_}, {gpu::kBindShadowRayTexels, texels_rgba32ui, &shadow_rays_},
                                   {gpu::kBindQueues, storage, &queues_},
                                   {gpu::kBindPathMedia, storage, &path_media_},
                                   {gpu::kBindPathAovs, storage, &path_aovs_}});
  // Film bands: what one buffer may hold, written as storage and read as texels.
  const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
  const std::uint64_t pixel_bytes = std::max<std::uint64_t>(gpu::kReplicates * sizeof(gpu::FilmPixel), sizeof(gpu::FilmAovs));
  const std::uint64_t range = std::min(device.info().max_storage_range, 16 * device.info().max_texel_elements);
  const std::uint64_t band_pixels = std::max<std::uint64_t>(1, range / pixel_bytes);
  for (std::uint64_t first = 0; first < pixels; first += band_pixels) {
    FilmBand& band = bands_.emplace_back();
    band.first_pixel = static_cast<std::uint32_t>(first);
    band.pixel_count = static_cast<std::uint32_t>(std::min(band_pixels, pixels - first));
    band.film = Buffer(device, std::uint64_t{band.pixel_count} * gpu::kReplicates * sizeof(gpu::FilmPixel));
    band.aovs = Buffer(device, features_ & gpu::kFeatureAovs ? std::uint64_t{band.pixel_count} * sizeof(gpu::FilmAovs) : 0);
  }
  for (FilmBand& band : bands_) { // in their final places: bindings point at the buffers
    std::vector<Binding> all = bindings;
    all.push_back({gpu::kBindFilm, storage, &band.film});
    all.push_back({gpu::kBindFilmTexels, texels_rgba32ui, &band.film});
    all.push_back({gpu::kBindFilmAovs, storage, &band.aovs});
    band.bindings = std::make_unique<BindingSet>(device, all, static_cast<std::uint32_t>(sizeof(gpu::Wave)));
  }
}

void PathTracer::create_kernels(Device& device, const RenderSettings& settings, std::uint32_t stack_size) {
  // Traversal marks the bottom of its stack, and stores one entry beyond what it keeps.
  const std::uint32_t stack = device.info().type == "cpu" ? gpu::kStackRegisters : gpu::kStackArray;
  const std::array<std::uint32_t, gpu::kSpecCount> constants = {
      features_, stack_size + 2, settings.sampler, settings.direct, settings.hemisphere, settings.filter, stack};
  kernels_.reserve(stage_count);
  for (const StageCode& stage : kStages) {
    kernels_.emplace_back(device, stage.name, stage.spirv, *bands_.front().bindings, constants);
    stages_.push_back({stage.name, 0.0, 0});
  }
}

double PathTracer::render_wave(const FilmBand& band, std::uint32_t first_pixel, std::uint32_t pixel_count,
                               std::uint32_t first_sample, std::uint32_t sample_count) {
  gpu::Wave wave{first_pixel, pixel_count, first_sample, sample_count, 0, band.first_pixel};
  const std::uint32_t bounces = frame_.max_depth + 1;
  const bool connects = frame_.light_count > 0;
  Commands commands(device_, std::min(2 + bounces * 5, 1024u));
  commands.bind(*band.bindings);
  commands.dispatch(kernels_[generate], groups_for(std::uint64_t{pixel_count} * sample_count), &wave);
  for (std::uint32_t bounce = 0; bounce < bounces; ++bounce) {
    commands.barrier();
    wave.bounce = 2 * bounce;
    commands.dispatch(kernels_[advance], 1, &wave);
    commands.barrier();
    wave.bounce = bounce;
    commands.dispatch_indirect(kernels_[extend], queues_, offsetof(gpu::Queues, extend_groups), &wave);
    commands.barrier();
    commands.dispatch_indirect(kernels_[shade], queues_, offsetof(gpu::Queues, extend_groups), &wave);
    if (!connects || bounce + 1 == bounces) continue; // the last bounce only collects emission
    commands.barrier();
    wave.bounce = 2 * bounce + 1;
    commands.dispatch(kernels_[advance], 1, &wave);
    commands.barrier();
    wave.bounce = bounce;
    commands.dispatch_indirect(kernels_[connect], queues_, offsetof(gpu::Queues, connect_groups), &wave);
  }
  commands.barrier();
  commands.dispatch(kernels_[accumulate], groups_for(pixel_count), &wave);
  commands.submit_and_wait();

  double longest = 0.0;
  for (const KernelTime& time : commands.times()) {
    StageTime& stage = stages_[static_cast<std::size_t>(time.kernel - kernels_.data())];
    stage.seconds += time.seconds;
    ++stage.dispatches;
    longest = std::max(longest, time.seconds);
  }
  return longest;
}

void PathTracer::warm_up() {
  reset();
  const FilmBand& band = bands_.front();
  render_wave(band, 0, std::min({gpu::kWorkgroupSize, band.pixel_count, frame_.slot_count}), 0, 1);
  reset();
}

void PathTracer::reset() {
  for (StageTime& stage : stages_) stage = {stage.name, 0.0, 0};
  for (FilmBand& band : bands_) {
    band.film.fill_zero();
    if (band.aovs.bytes()) band.aovs.fill_zero();
  }
  gpu::Queues queues{};
  queues.first_nonfinite_pixel = gpu::kNone;
  queues_.write(&queues, sizeof(queues));
}

gpu::Queues PathTracer::counters() const {
  gpu::Queues queues{};
  queues_.read(&queues, sizeof(queues));
  return queues;
}

MemoryUse PathTracer::memory() const {
  MemoryUse use;
  use.bvh = scene_.bvh_bytes();
  use.scene = scene_.other_bytes();
  use.paths = paths_.bytes() + path_media_.bytes() + path_aovs_.bytes() + rays_.bytes() + hits_.bytes() +
              shadow_rays_.bytes() + queues_.bytes() + frame_buffer_.bytes();
  for (const FilmBand& band : bands_) use.film += band.film.bytes() + band.aovs.bytes();
  return use;
}

} // namespace wavepath
