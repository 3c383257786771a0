#include "host/integrators/path/path_tracer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <numeric>
#include <utility>

#include "host/render/adaptive.h"
#include "kernels/features.h"
#include "kernels/film/film_types.h"
#include "kernels/frame_types.h"
#include "kernels/hybrid/hybrid_types.h"
#include "kernels/path/path_types.h"

namespace wavepath {
namespace {

constexpr std::uint64_t kFilmPixelBytes = gpu::kReplicates * sizeof(gpu::FilmPixel);

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
  const bool path = settings.integrator == Integrator::path;
  frame.max_depth = path ? settings.max_depth : std::min(settings.max_depth, 1u); // the rest is the ambient term's
  frame.seed = settings.seed;
  frame.environment_radiance = scene.environment_radiance;
  frame.environment_probability = scene.environment_probability;
  frame.environment_rotation = glm::vec2(std::cos(scene.environment_rotation), std::sin(scene.environment_rotation));
  frame.environment_width = scene.environment_width;
  frame.environment_height = scene.environment_height;
  frame.light_count = static_cast<std::uint32_t>(scene.lights.size());
  frame.root = scene.root;
  frame.root_is_top = scene.root_is_top ? 1u : 0u;
  const std::uint64_t total = settings.sample_total > 0 ? settings.sample_total : settings.last_sample;
  const bool hybrid = settings.integrator == Integrator::hybrid;
  frame.sample_total =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(total * (hybrid ? settings.shadow_samples : 1), gpu::kNone));
  frame.slot_count = slots;
  frame.scene_features = scene.features;
  return frame;
}

std::vector<Binding> all_bindings(const GpuScene& scene, const PathBuffers& paths, const Buffer& visibility,
                                  const FilmBand& band) {
  std::vector<Binding> bindings = scene.bindings();
  using enum BindingKind;
  bindings.insert(bindings.end(), {{gpu::kBindFrame, uniform, &paths.frame},
                                   {gpu::kBindPaths, storage, &paths.states},
                                   {gpu::kBindPathTexels, texels_rgba32f, &paths.states},
                                   {gpu::kBindRays, storage, &paths.rays},
                                   {gpu::kBindRayTexels, texels_rgba32f, &paths.rays},
                                   {gpu::kBindHits, storage, &paths.hits},
                                   {gpu::kBindHitTexels, texels_rgba32ui, &paths.hits},
                                   {gpu::kBindShadowRays, storage, &paths.shadow_rays},
                                   {gpu::kBindShadowRayTexels, texels_rgba32ui, &paths.shadow_rays},
                                   {gpu::kBindQueues, storage, &paths.queues},
                                   {gpu::kBindPathMedia, storage, &paths.media},
                                   {gpu::kBindPathAovs, storage, &paths.aovs},
                                   {gpu::kBindFilm, storage, &band.film},
                                   {gpu::kBindFilmTexels, texels_rgba32ui, &band.film},
                                   {gpu::kBindRuns, texels_r32ui, &paths.runs},
                                   {gpu::kBindFilmAovs, storage, &band.aovs},
                                   {gpu::kBindHybrid, uniform, &paths.hybrid},
                                   {gpu::kBindVisibility, texels_rg32ui, &visibility},
                                   {gpu::kBindGbuffer, storage, &paths.gbuffer},
                                   {gpu::kBindSignals, storage, &paths.signals},
                                   {gpu::kBindSeen, storage, &paths.seen},
                                   {gpu::kBindJitters, storage, &paths.jitters}});
  return bindings;
}

std::uint32_t needed_features(const PackedScene& scene, const View& view, const RenderSettings& settings) {
  const std::uint32_t camera = view.orthographic ? gpu::kFeatureOrthographic : 0;
  return scene.features | camera | features_of(settings);
}

gpu::Queues empty_queues() {
  gpu::Queues queues{};
  std::ranges::fill(queues.nonfinite_first, gpu::kNone);
  return queues;
}

std::uint64_t join(const std::uint32_t words[2]) { return std::uint64_t{words[1]} << 32 | words[0]; }

} // namespace

std::uint32_t choose_slots(const DeviceInfo& info, const PackedScene& scene, const RenderSettings& settings) {
  const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
  const std::uint64_t samples = settings.last_sample - settings.first_sample;
  std::uint64_t slots = info.type == "cpu" ? 1u << 17 : 1u << 21;
  if (settings.wave_slots) slots = settings.wave_slots;
  // A hybrid pixel takes a slot for each of its light samples at once.
  const std::uint64_t least = settings.integrator == Integrator::path ? 1 : settings.shadow_samples;
  slots = std::max(std::min(slots, pixels * samples), least);
  if (settings.adaptive) slots = std::max<std::uint64_t>(slots, kLargestRun);
  slots = std::min(slots, info.max_storage_range / std::max(2 * sizeof(gpu::Ray), sizeof(gpu::PathAovs)));
  slots = std::min(slots, info.max_texel_elements / 4);
  slots = std::min<std::uint64_t>(slots, std::uint64_t{info.max_groups} * gpu::kWorkgroupSize);
  slots = std::min(slots, std::max<std::uint64_t>(info.memory_bytes / 8 / bytes_per_slot(scene.features), 1024));
  return static_cast<std::uint32_t>(std::max(slots, least));
}

RayCounts ray_counts(const gpu::Queues& queues) {
  return {join(queues.camera_rays), join(queues.bounce_rays), join(queues.shadow_rays), join(queues.occlusion_rays)};
}

std::uint64_t bytes_per_slot(std::uint32_t features) {
  std::uint64_t bytes = sizeof(gpu::PathState) + 2 * sizeof(gpu::Ray) + sizeof(gpu::Hit) + sizeof(gpu::ShadowRay);
  if (features & gpu::kFeatureVolume) bytes += sizeof(std::uint32_t);
  if (features & gpu::kFeatureAovs) bytes += sizeof(gpu::PathAovs);
  return bytes;
}

std::vector<Binding> path_tracer_bindings() {
  std::vector<Binding> bindings = all_bindings({}, {}, {}, {});
  for (Binding& binding : bindings) binding.buffer = nullptr;
  return bindings;
}

PathTracer::PathTracer(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
                       std::uint32_t slots, KernelCompiler& kernels)
    : device_(device),
      frame_(make_frame(scene, view, settings, slots)),
      kernels_(kernels),
      config_(kernel_config(needed_features(scene, view, settings), scene.stack_size, settings)),
      traces_paths_(settings.integrator != Integrator::ao) {
  begin_kernels(settings);
  const auto start = std::chrono::steady_clock::now();
  scene_ = upload_scene(device, scene);
  upload_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  allocate(scene, settings);
}

std::uint64_t PathBuffers::bytes() const {
  return frame.bytes() + states.bytes() + media.bytes() + aovs.bytes() + rays.bytes() + hits.bytes() +
         shadow_rays.bytes() + queues.bytes() + runs.bytes() + hybrid.bytes() + gbuffer.bytes() + signals.bytes() +
         seen.bytes() + jitters.bytes();
}

void PathTracer::change(const PackedScene& scene, const View& view, const RenderSettings& settings) {
  frame_ = make_frame(scene, view, settings, frame_.slot_count);
  config_ = kernel_config(needed_features(scene, view, settings), scene.stack_size, settings);
  traces_paths_ = settings.integrator != Integrator::ao;
  begin_kernels(settings);
  allocate(scene, settings);
  reset();
}

void PathTracer::begin_kernels(const RenderSettings& settings) {
  if (traces_paths_) kernels_.start(config_);
  features_ = config_.features | kernels_.features();
  has_aovs_ = !settings.aovs.empty();
  stages_.clear();
  for (std::size_t stage = 0; stage < kStageCount && settings.integrator == Integrator::path; ++stage)
    stages_.push_back({stage_name(static_cast<Stage>(stage)), 0.0, 0});
}

void PathTracer::allocate(const PackedScene& scene, const RenderSettings& settings) {
  const bool moved_paths = make_room_for_paths(settings), moved_film = make_room_for_film(settings);
  const bool moved_frames = make_room_for_frames(scene, settings, moved_paths);
  paths_.frame.write(&frame_, sizeof(gpu::Frame));
  if (settings.adaptive) {
    const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
    std::vector<std::uint32_t> runs((pixels + gpu::kRunPixels - 1) / gpu::kRunPixels);
    std::iota(runs.begin(), runs.end(), 0u);
    set_runs(runs);
  }
  if (!moved_paths && !moved_film && !moved_frames) return;
  for (FilmBand& band : bands_) { // in their final places: bindings point at the buffers
    const std::vector<Binding> bindings = all_bindings(scene_, paths_, visibility_ ? visibility_->ids() : paths_.jitters, band);
    band.bindings = std::make_unique<BindingSet>(device_, bindings, static_cast<std::uint32_t>(sizeof(gpu::Wave)));
  }
}

// Whether another buffer had to take its place; what the old one held is lost then.
bool PathTracer::make_room(Buffer& buffer, std::uint64_t bytes) {
  if (buffer.handle() && buffer.bytes() >= bytes) return false;
  buffer = Buffer(); // both at once may be too much
  buffer = Buffer(device_, bytes);
  return true;
}

bool PathTracer::make_room_for_paths(const RenderSettings& settings) {
  const std::uint64_t slots = frame_.slot_count;
  const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
  const bool hybrid = settings.integrator != Integrator::path, seen = settings.integrator == Integrator::hybrid || (hybrid && settings.antialias_over_time);
  const bool shadows = frame_.light_count || settings.room_for_shadow_rays;
  const std::uint64_t runs = features_ & gpu::kFeatureAdaptive ? (pixels + gpu::kRunPixels - 1) / gpu::kRunPixels : 0;
  bool moved = false;
  for (const auto& [buffer, bytes] : std::initializer_list<std::pair<Buffer*, std::uint64_t>>{
           {&paths_.frame, sizeof(gpu::Frame)},
           {&paths_.states, slots * sizeof(gpu::PathState)},
           {&paths_.media, features_ & gpu::kFeatureVolume ? slots * sizeof(std::uint32_t) : 0},
           {&paths_.aovs, features_ & gpu::kFeatureAovs ? slots * sizeof(gpu::PathAovs) : 0},
           {&paths_.rays, 2 * slots * sizeof(gpu::Ray)},
           {&paths_.hits, slots * sizeof(gpu::Hit)},
           {&paths_.shadow_rays, shadows ? slots * sizeof(gpu::ShadowRay) : 0},
           {&paths_.queues, sizeof(gpu::Queues)},
           {&paths_.runs, runs * sizeof(std::uint32_t)},
           {&paths_.hybrid, hybrid ? sizeof(gpu::HybridFrame) : 0},
           {&paths_.gbuffer, hybrid ? pixels * sizeof(gpu::GbufferPixel) : 0},
           {&paths_.signals, hybrid ? pixels * sizeof(glm::vec4) : 0},
           {&paths_.seen, seen ? pixels * sizeof(glm::vec4) : 0},
           {&paths_.jitters, hybrid ? gpu::kJitters * sizeof(glm::vec2) : 0}})
    moved |= make_room(*buffer, bytes);
  return moved;
}

// Film bands: what one buffer may hold, written as storage and read as texels. Bands of a larger picture stay, empty.
bool PathTracer::make_room_for_film(const RenderSettings& settings) {
  const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
  const DeviceInfo& info = device_.info();
  const std::uint64_t range = std::min(info.max_storage_range, 16 * info.max_texel_elements);
  const std::uint64_t most = range / std::max(kFilmPixelBytes, sizeof(gpu::FilmAovs)) / gpu::kRunPixels *
                             gpu::kRunPixels; // no run lies in two
  bands_.resize(std::max<std::size_t>(bands_.size(), (pixels + most - 1) / most));
  const bool aovs = has_aovs_ || features_ & gpu::kFeatureAovs;
  bool moved = false;
  std::uint64_t first = 0;
  for (FilmBand& band : bands_) {
    band.first_pixel = static_cast<std::uint32_t>(first);
    band.pixel_count = static_cast<std::uint32_t>(std::min(most, pixels - first));
    first += band.pixel_count;
    moved |= make_room(band.film, band.pixel_count * kFilmPixelBytes);
    moved |= make_room(band.aovs,
                       aovs ? std::uint64_t{band.pixel_count} * sizeof(gpu::FilmAovs) : 0);
  }
  return moved;
}

// `moved_paths`: buffers that it was bound to are gone.
bool PathTracer::make_room_for_frames(const PackedScene& scene, const RenderSettings& settings, bool moved_paths) {
  const bool wanted = settings.integrator != Integrator::path;
  const glm::uvec3 made_for = wanted ? glm::uvec3(settings.width, settings.height, config_.features) : glm::uvec3(0);
  if (made_for == visibility_made_for_ && !moved_paths) return false;
  visibility_made_for_ = made_for;
  visibility_.reset(); // both at once may be too much
  if (wanted)
    visibility_ = std::make_unique<Visibility>(device_, scene, scene_, paths_.frame, paths_.hybrid, config_.features,
                                               settings.width, settings.height);
  return true;
}

double PathTracer::render_wave(const FilmBand& band, std::uint32_t first_pixel, std::uint32_t pixel_count,
                               std::uint32_t first_sample, std::uint32_t sample_count) {
  const KernelSet& kernels = kernels_.best(config_); // may be a better one than in the last wave
  gpu::Wave wave{first_pixel, pixel_count, first_sample, sample_count, 0, band.first_pixel};
  const std::uint32_t bounces = frame_.max_depth + 1;
  const bool connects = frame_.light_count > 0;
  Commands commands(device_, std::min(2 + bounces * 5, 1024u));
  commands.bind(*band.bindings);
  commands.dispatch(kernels[kGenerate], groups_for(std::uint64_t{pixel_count} * sample_count), &wave);
  for (std::uint32_t bounce = 0; bounce < bounces; ++bounce) {
    commands.barrier();
    wave.bounce = 2 * bounce;
    commands.dispatch(kernels[kAdvance], 1, &wave);
    commands.barrier();
    wave.bounce = bounce;
    commands.dispatch_indirect(kernels[kExtend], paths_.queues, offsetof(gpu::Queues, extend_groups), &wave);
    commands.barrier();
    commands.dispatch_indirect(kernels[kShade], paths_.queues, offsetof(gpu::Queues, extend_groups), &wave);
    if (!connects || bounce + 1 == bounces) continue; // the last bounce only collects emission
    commands.barrier();
    wave.bounce = 2 * bounce + 1;
    commands.dispatch(kernels[kAdvance], 1, &wave);
    commands.barrier();
    wave.bounce = bounce;
    commands.dispatch_indirect(kernels[kConnect], paths_.queues, offsetof(gpu::Queues, connect_groups), &wave);
  }
  commands.barrier();
  commands.dispatch(kernels[kAccumulate], groups_for(pixel_count), &wave);
  commands.submit_and_wait();
  collect_nonfinite(wave);
  return count_times(commands);
}

void PathTracer::count_time(const std::string& name, double seconds) {
  auto stage = std::ranges::find(stages_, name, &StageTime::name);
  if (stage == stages_.end()) stage = stages_.insert(stage, {name, 0.0, 0});
  stage->seconds += seconds;
  ++stage->dispatches;
}

double PathTracer::count_times(const Commands& commands) {
  double longest = 0.0;
  for (const KernelTime& time : commands.times()) {
    count_time(time.kernel->name(), time.seconds);
    longest = std::max(longest, time.seconds);
  }
  return longest;
}

// The counts of one wave become part of the totals here, because only the host knows which samples its slots were.
void PathTracer::collect_nonfinite(const gpu::Wave& wave) {
  const auto pixel_at = [&](std::uint32_t place) {
    return runs_.empty() ? place : runs_[place / gpu::kRunPixels] * gpu::kRunPixels + place % gpu::kRunPixels;
  };
  if (!nonfinite_.add(counters(), wave, pixel_at)) return;
  const gpu::Queues none = empty_queues();
  const std::uint64_t begin = offsetof(gpu::Queues, nonfinite_count);
  paths_.queues.write(&none.nonfinite_count, sizeof(none) - begin, begin);
}

double PathTracer::get_ready() {
  reset();
  return traces_paths_ ? kernels_.best(config_).seconds() : 0.0;
}

void PathTracer::reset() {
  for (StageTime& stage : stages_) stage = {stage.name, 0.0, 0};
  empty_film();
  const gpu::Queues queues = empty_queues();
  paths_.queues.write(&queues, sizeof(queues));
}

void PathTracer::set_runs(const std::vector<std::uint32_t>& runs) {
  runs_ = runs;
  paths_.runs.write(runs.data(), runs.size() * sizeof(std::uint32_t));
}

void PathTracer::set_seed(std::uint32_t seed) {
  frame_.seed = seed;
  paths_.frame.write(&frame_, sizeof(gpu::Frame));
}

void PathTracer::set_counters(gpu::Queues counters, std::vector<StageTime> stages, const Nonfinite& nonfinite) {
  paths_.queues.write(&counters, sizeof(counters));
  stages_ = std::move(stages);
  nonfinite_ = nonfinite;
}

void PathTracer::empty_film() {
  for (FilmBand& band : bands_) {
    band.film.fill_zero(band.pixel_count * kFilmPixelBytes);
    if (band.aovs.bytes()) band.aovs.fill_zero(band.pixel_count * sizeof(gpu::FilmAovs));
  }
  nonfinite_ = {}; // of samples that are no longer in it
}

gpu::Queues PathTracer::counters() const {
  gpu::Queues queues{};
  paths_.queues.read(&queues, sizeof(queues));
  return queues;
}

MemoryUse PathTracer::memory() const {
  MemoryUse use;
  use.bvh = scene_.bvh_bytes();
  use.scene = scene_.other_bytes();
  use.paths = paths_.bytes();
  if (visibility_) use.paths += visibility_->bytes();
  for (const FilmBand& band : bands_) use.film += band.film.bytes() + band.aovs.bytes();
  return use;
}

} // namespace wavepath
