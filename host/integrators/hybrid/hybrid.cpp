#include "host/integrators/hybrid/hybrid.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <future>
#include <span>

#include "host/integrators/hybrid/denoise.h"
#include "host/render/governor.h"
#include "host/integrators/hybrid/taa.h"
#include "kernels/hybrid/composite.spv.h"
#include "kernels/hybrid/gather.spv.h"
#include "kernels/hybrid/jitter.spv.h"
#include "kernels/hybrid/occlusion.spv.h"
#include "kernels/hybrid/resolve.spv.h"
#include "kernels/tile_order.h"

namespace wavepath {
namespace {

struct StageCode {
  const char* name;
  std::span<const std::uint32_t> spirv;
};
constexpr std::uint32_t kPilotSeed = 0x6a09e667u;
constexpr std::uint32_t kPilotPixels = 1u << 14, kPilotBlock = 1u << 10; // enough for a mean, in a moment
constexpr std::uint32_t kCompositePixels = 1u << 16; // of a dispatch: some tens of milliseconds on two cores
constexpr std::uint64_t kStandInBytes = 1024; // of the buffer that stands for all while nothing is read

// Light beyond the direct one is wanted where paths would be longer than it.
std::uint32_t frame_flags(const RenderSettings& settings) {
  if (settings.integrator == Integrator::ao) return gpu::kHybridAmbient;
  return gpu::kHybridLights | (settings.max_depth > 1 ? gpu::kHybridAmbient : 0);
}

float ray_length(double radius) {
  return radius > 0.0 ? static_cast<float>(std::min<double>(radius, gpu::kFar)) : gpu::kFar;
}

} // namespace

std::uint64_t bytes_per_frame_pixel(const RenderSettings& settings) {
  constexpr std::uint64_t kIds = 2 * sizeof(std::uint32_t), kDepth = sizeof(float); // drawn, and copied once
  return sizeof(gpu::GbufferPixel) + 2 * sizeof(gpu::vec4) + 2 * kIds + kDepth +
         (settings.denoise ? Denoiser::kBytesPerPixel : 0);
}

double occlusion_radius(const PackedScene& scene, const RenderSettings& settings) {
  return settings.ao_radius.value_or(settings.integrator == Integrator::ao ? 0.0 : 0.1 * scene.radius);
}

Hybrid::Hybrid(Device& device, PathTracer& tracer, const PackedScene& scene, const View& view,
               const RenderSettings& settings)
    : device_(device), tracer_(tracer) {
  change(scene, view, settings);
}

Hybrid::~Hybrid() = default;

void Hybrid::change(const PackedScene& scene, const View& view, const RenderSettings& settings, Past past) {
  const glm::vec3 ambient = past == Past::keep ? frame_.ambient : glm::vec3(0.0f);
  settings_ = settings;
  camera_ = camera_of(scene, view);
  frame_ = {};
  frame_.flags = frame_flags(settings);
  frame_.shadow_samples = settings.integrator == Integrator::hybrid ? settings.shadow_samples : 1;
  frame_.ao_samples = settings.ao_samples;
  frame_.ao_radius = ray_length(occlusion_radius(scene, settings));
  frame_.ambient = settings.ambient.value_or(ambient);
  const ClipPlanes planes = clip_planes(scene, view);
  frame_.near = planes.near;
  frame_.far = planes.far;
  edges_hold_ = edges_hold(scene, view, settings.width, settings.height);
  jitters_.clear();
  remake_filters(past);

  Needs needs{tracer_.config_, frame_.flags};
  if (!settings.aovs.empty()) needs.config.features |= gpu::kFeatureAovs;
  if (needs == needs_) return;
  needs_ = needs;
  compiling_ = std::async(std::launch::async, [&device = device_, needs] { return compile(device, needs); });
}

// Memory and kernels stay, unless size or buffers are others.
void Hybrid::remake_filters(Past past) {
  const std::uint32_t which = (settings_.denoise ? 1u : 0u) | (settings_.antialias_over_time ? 2u : 0u);
  const glm::uvec4 made_for = which ? glm::uvec4(settings_.width, settings_.height, frame_.flags, which) : glm::uvec4(0);
  const BindingSet* bound = tracer_.bands_.front().bindings.get(); // another one where buffers are others
  if (made_for == filters_made_for_ && bound == filters_bound_) {
    if (past == Past::keep) return;
    if (denoiser_) denoiser_->forget();
    if (taa_) taa_->forget();
    return;
  }
  filters_made_for_ = made_for;
  filters_bound_ = bound;
  denoiser_.reset(); // both at once may be too much
  taa_.reset();
  const PathBuffers& buffers = tracer_.paths_;
  if (settings_.denoise)
    denoiser_ = std::make_unique<Denoiser>(device_, settings_.width, settings_.height, buffers.gbuffer, buffers.signals,
                                           frame_.flags);
  if (settings_.antialias_over_time)
    taa_ = std::make_unique<Taa>(device_, settings_.width, settings_.height, buffers.gbuffer, buffers.seen);
}

bool Hybrid::is_ready() const {
  return !compiling_.valid() || compiling_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

double Hybrid::get_ready() {
  if (compiling_.valid()) kernels_ = std::make_unique<Kernels>(compiling_.get());
  return kernels_->seconds;
}

Hybrid::Kernels Hybrid::compile(Device& device, const Needs& needs) {
  static const std::array<StageCode, kFrameStageCount> codes = {{{"jitter", wavepath_jitter_spv},
                                                            {"resolve", wavepath_resolve_spv},
                                                            {"occlusion", wavepath_occlusion_spv},
                                                            {"gather", wavepath_gather_spv},
                                                            {"composite", wavepath_composite_spv}}};
  const auto start = std::chrono::steady_clock::now();
  const auto constants = specialization(needs.config, device.info());
  const Buffer stand_in(device, kStandInBytes);
  std::vector<Binding> stand_ins = path_tracer_bindings();
  for (Binding& binding : stand_ins) binding.buffer = &stand_in;
  const BindingSet bindings(device, stand_ins, static_cast<std::uint32_t>(sizeof(gpu::Wave)));
  Kernels kernels;
  std::vector<std::future<void>> compiling;
  for (std::size_t stage = 0; stage < kFrameStageCount; ++stage) {
    if (stage == kOcclusion && !(needs.flags & gpu::kHybridAmbient)) continue;
    if (stage == kGather && !(needs.flags & gpu::kHybridLights)) continue;
    compiling.push_back(std::async(std::launch::async, [&, stage] {
      kernels.by_stage[stage].emplace(device, codes[stage].name, codes[stage].spirv, bindings, constants);
      const gpu::Wave nothing{};
      Commands commands(device); // some drivers compile at the first dispatch
      commands.bind(bindings);
      commands.dispatch(*kernels.by_stage[stage], 0, &nothing);
      commands.submit_and_wait();
    }));
  }
  for (std::future<void>& one : compiling) one.get();
  kernels.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return kernels;
}

std::uint64_t Hybrid::bytes() const { return (denoiser_ ? denoiser_->bytes() : 0) + (taa_ ? taa_->bytes() : 0); }

// kJitters frames at a time, because asking the device costs a round trip.
glm::vec2 Hybrid::jitter(std::uint32_t sample) {
  if (jitters_.empty() || sample < first_jitter_ || sample - first_jitter_ >= jitters_.size()) {
    first_jitter_ = sample;
    gpu::Wave wave{};
    wave.first_sample = sample;
    Commands commands(device_, 1);
    commands.bind(*tracer_.bands_.front().bindings);
    commands.dispatch(kernel(kJitter), groups_for(gpu::kJitters), &wave);
    commands.submit_and_wait();
    tracer_.count_times(commands);
    jitters_ = download<glm::vec2>(tracer_.paths_.jitters, gpu::kJitters);
  }
  return jitters_[sample - first_jitter_];
}

double Hybrid::begin_frame(std::uint32_t sample) {
  frame_.sample_index = sample;
  tracer_.paths_.hybrid.write(&frame_, sizeof(frame_)); // the jitter kernel reads it
  frame_.jitter = jitter(sample);
  tracer_.paths_.hybrid.write(&frame_, sizeof(frame_));
  const double before = tracer_.visibility_->seconds();
  const double longest = edges_hold_ ? tracer_.visibility_->render(camera_) : tracer_.visibility_->trace();
  tracer_.count_time("raster", tracer_.visibility_->seconds() - before);
  return longest;
}

std::uint32_t Hybrid::samples_per_pixel() const {
  return std::max(frame_.shadow_samples, frame_.flags & gpu::kHybridAmbient ? frame_.ao_samples : 0);
}

double Hybrid::render_wave(const FilmBand& band, std::uint32_t first_pixel, std::uint32_t pixel_count) {
  const bool lights = frame_.flags & gpu::kHybridLights;
  const std::uint32_t samples = frame_.shadow_samples;
  const std::uint64_t slots = std::uint64_t{pixel_count} * samples;
  // As hybrid_sample() of kernels/frame_terms.glsl numbers them.
  const std::uint32_t round = frame_.sample_index / gpu::kReplicates,
                      replicate = frame_.sample_index % gpu::kReplicates;
  gpu::Wave wave{first_pixel, pixel_count, round * samples * gpu::kReplicates + replicate,
                 samples,     0,           band.first_pixel};
  Commands commands(device_, 16);
  commands.bind(*band.bindings);
  commands.dispatch(kernel(kResolve), groups_for(pixel_count), &wave);
  commands.barrier();
  if (frame_.flags & gpu::kHybridAmbient) {
    commands.dispatch(kernel(kOcclusion), groups_for(pixel_count), &wave);
    commands.barrier(); // it reads the rays that shading replaces
  }
  if (lights) {
    light(commands, wave, groups_for(slots));
    commands.barrier();
    commands.dispatch(kernel(kGather), groups_for(pixel_count), &wave);
  }
  commands.submit_and_wait();
  tracer_.collect_nonfinite(wave);
  return tracer_.count_times(commands);
}

// Direct light as in PathTracer::render_wave(), from the first hit on.
void Hybrid::light(Commands& commands, gpu::Wave wave, std::uint32_t groups) {
  const KernelSet& paths = tracer_.kernels_.best(tracer_.config_);
  const Buffer& queues = tracer_.paths_.queues;
  commands.dispatch(paths[kShade], groups, &wave);
  if (tracer_.frame_.max_depth == 0) return;
  if (tracer_.frame_.light_count > 0) {
    commands.barrier();
    wave.bounce = 1;
    commands.dispatch(paths[kAdvance], 1, &wave);
    commands.barrier();
    wave.bounce = 0;
    commands.dispatch_indirect(paths[kConnect], queues, offsetof(gpu::Queues, connect_groups), &wave);
  }
  // Light that a sampled direction runs into.
  commands.barrier();
  wave.bounce = 2;
  commands.dispatch(paths[kAdvance], 1, &wave);
  commands.barrier();
  wave.bounce = 1;
  commands.dispatch_indirect(paths[kExtend], queues, offsetof(gpu::Queues, extend_groups), &wave);
  commands.barrier();
  commands.dispatch_indirect(paths[kShade], queues, offsetof(gpu::Queues, extend_groups), &wave);
}

double Hybrid::end_frame() {
  camera_.jitter_x = frame_.jitter.x;
  camera_.jitter_y = frame_.jitter.y;
  double longest = 0.0;
  if (denoiser_) {
    Commands commands(device_, denoiser_->dispatches());
    denoiser_->record(commands, camera_);
    commands.submit_and_wait();
    longest = tracer_.count_times(commands);
  }
  if (!taa_) return std::max(longest, composite(frame_.flags));
  longest = std::max(longest, composite(frame_.flags | gpu::kHybridToColor));
  longest = std::max(longest, antialias());
  return std::max(longest, composite(frame_.flags | gpu::kHybridFromColor));
}

double Hybrid::antialias() {
  Commands commands(device_, taa_->dispatches());
  taa_->record(commands, camera_);
  commands.copy(taa_->result(), tracer_.paths_.seen,
                std::uint64_t{settings_.width} * settings_.height * sizeof(glm::vec4));
  commands.submit_and_wait();
  return tracer_.count_times(commands);
}

double Hybrid::composite(std::uint32_t flags) {
  gpu::HybridFrame frame = frame_;
  frame.flags = flags;
  tracer_.paths_.hybrid.write(&frame, sizeof(frame));
  double longest = 0.0;
  for (const FilmBand& band : tracer_.bands_) {
    if (band.pixel_count == 0) continue;
    Commands commands(device_, (band.pixel_count + kCompositePixels - 1) / kCompositePixels);
    commands.bind(*band.bindings);
    for (std::uint32_t done = 0; done < band.pixel_count; done += kCompositePixels) {
      const std::uint32_t count = std::min(kCompositePixels, band.pixel_count - done);
      const gpu::Wave wave{band.first_pixel + done, count, 0, 1, 0, band.first_pixel};
      commands.dispatch(kernel(kComposite), groups_for(count), &wave);
    }
    commands.submit_and_wait();
    longest = std::max(longest, tracer_.count_times(commands));
  }
  return longest;
}

// The light inside an integrating sphere: of what surfaces send out, the share that meets surfaces again is sent out
// once more, L = direct + albedo * enclosure * L. What arrives where the picture looks is that L from the enclosed
// directions.
void Hybrid::estimate_ambient() {
  if (settings_.integrator != Integrator::hybrid || settings_.ambient || !(frame_.flags & gpu::kHybridAmbient)) return;
  const gpu::HybridFrame asked = frame_;
  frame_.ao_radius = gpu::kFar; // to tell how enclosed the place is
  tracer_.set_seed(settings_.seed ^ kPilotSeed);
  jitters_.clear();
  begin_frame(0);
  const std::vector<std::uint32_t> places = light_pilot();
  frame_ = asked;
  tracer_.set_seed(settings_.seed);
  tracer_.nonfinite_ = {};
  jitters_.clear();
  frame_.ambient = enclosed_light(places);
}

// Lights blocks of pixels spread evenly over the picture. Returns their places, row-major.
std::vector<std::uint32_t> Hybrid::light_pilot() {
  const std::uint32_t width = tracer_.frame_.width, height = tracer_.frame_.height, pixels = width * height;
  const std::uint32_t blocks = std::min(kPilotPixels, pixels + kPilotBlock - 1) / kPilotBlock;
  Governor governor(tracer_.slots());
  std::vector<std::uint32_t> places;
  for (std::uint32_t block = 0; block < std::max(blocks, 1u); ++block) {
    const auto first = static_cast<std::uint32_t>(std::uint64_t{pixels} * block / std::max(blocks, 1u));
    const FilmBand& band = *std::ranges::find_if(tracer_.bands_, [&](const FilmBand& b) {
      return first >= b.first_pixel && first - b.first_pixel < b.pixel_count;
    });
    const std::uint32_t end = std::min(first + kPilotBlock, band.first_pixel + band.pixel_count);
    for (std::uint32_t done = first; done < end;) {
      const std::uint32_t count = std::min(std::max(governor.wave() / samples_per_pixel(), 1u), end - done);
      governor.report(render_wave(band, done, count), count * samples_per_pixel());
      done += count;
    }
    for (std::uint32_t pixel = first; pixel < end; ++pixel) {
      const glm::uvec2 at = gpu::pixel_in_tile_order(pixel, width, height);
      places.push_back(at.y * width + at.x);
    }
  }
  return places;
}

glm::vec3 Hybrid::enclosed_light(std::span<const std::uint32_t> places) const {
  const std::size_t pixels = std::size_t{tracer_.frame_.width} * tracer_.frame_.height;
  const auto gbuffer = download<gpu::GbufferPixel>(tracer_.paths_.gbuffer, pixels);
  const auto signals = download<glm::vec4>(tracer_.paths_.signals, pixels);
  glm::dvec3 direct(0.0), albedo(0.0);
  double unoccluded = 0.0, count = 0.0;
  for (const std::uint32_t i : places) {
    const glm::dvec3 light = glm::dvec3(signals[i]) * glm::dvec3(glm::max(gbuffer[i].albedo, gpu::kDemodulationFloor));
    if (!(gbuffer[i].depth > 0.0f) || !std::isfinite(light.x + light.y + light.z)) continue;
    direct += light;
    albedo += gbuffer[i].albedo;
    unoccluded += signals[i].w;
    ++count;
  }
  if (count == 0.0) return glm::vec3(0.0f);
  const double enclosure = 1.0 - unoccluded / count;
  const glm::dvec3 sent_out = direct / (count - glm::min(albedo, count * 0.99) * enclosure);
  return glm::vec3(sent_out * enclosure);
}

} // namespace wavepath
