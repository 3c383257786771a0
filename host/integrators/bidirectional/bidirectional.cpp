#include "host/integrators/bidirectional/bidirectional.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "host/render/loop/render_result.h"
#include "host/render/workspace/wave_queue.h"
#include "host/scene/pack/bodies.h"
#include "host/scene/pack/features.h"
#include "kernels/bidirectional/bidirectional_collide.spv.h"
#include "kernels/bidirectional/bidirectional_connect.spv.h"
#include "kernels/bidirectional/bidirectional_connect_query.spv.h"
#include "kernels/bidirectional/bidirectional_shade.spv.h"
#include "kernels/bidirectional/bidirectional_shade_layered.spv.h"
#include "kernels/bidirectional/connection_advance.spv.h"
#include "kernels/bidirectional/light_extend.spv.h"
#include "kernels/bidirectional/light_extend_query.spv.h"
#include "kernels/bidirectional/light_generate.spv.h"
#include "kernels/bidirectional/light_shade.spv.h"
#include "kernels/bidirectional/light_shade_layered.spv.h"
#include "kernels/bidirectional/light_splat.spv.h"
#include "kernels/bidirectional/light_splat_query.spv.h"
#include "kernels/bidirectional/photon_clear.spv.h"
#include "kernels/bidirectional/photon_gather.spv.h"
#include "kernels/bidirectional/photon_gather_layered.spv.h"
#include "kernels/bidirectional/photon_link.spv.h"
#include "kernels/bidirectional/photon_shade.spv.h"
#include "kernels/bidirectional/photon_shade_layered.spv.h"

namespace wavepath {
namespace {

enum Stage : std::size_t {
  kLightGenerate,
  kLightExtend,
  kLightShade,
  kLightSplat,
  kCameraShade,
  kCameraConnect,
  kConnectionAdvance,
  kPhotonClear,
  kPhotonShade,
  kPhotonLink,
  kPhotonGather,
  kCameraCollide,
  kStageCount
};
const std::array<KernelCode, kStageCount> kStages = {
    {{"light generate", wavepath_light_generate_spv},
     {"light extend", wavepath_light_extend_spv, {}, wavepath_light_extend_query_spv},
     {"light shade", wavepath_light_shade_spv, wavepath_light_shade_layered_spv},
     {"light splat", wavepath_light_splat_spv, {}, wavepath_light_splat_query_spv},
     {"bidirectional shade", wavepath_bidirectional_shade_spv, wavepath_bidirectional_shade_layered_spv},
     {"bidirectional connect", wavepath_bidirectional_connect_spv, {}, wavepath_bidirectional_connect_query_spv},
     {"connection advance", wavepath_connection_advance_spv},
     {"photon clear", wavepath_photon_clear_spv},
     {"photon shade", wavepath_photon_shade_spv, wavepath_photon_shade_layered_spv},
     {"photon link", wavepath_photon_link_spv},
     {"photon gather", wavepath_photon_gather_spv, wavepath_photon_gather_layered_spv},
     {"bidirectional collide", wavepath_bidirectional_collide_spv}}};
constexpr std::array<std::size_t, kStageCount> kCompileOrder = {
    kCameraShade,   kCameraCollide,     kLightShade,   kLightExtend, kLightSplat, kCameraConnect,
    kLightGenerate, kConnectionAdvance, kPhotonGather, kPhotonShade, kPhotonLink, kPhotonClear};
// Limits of the photon passes.
constexpr std::uint32_t kPhotonWave = 1u << 16; // light paths that are followed at once
constexpr std::uint32_t kPhotonStages =
    1u << kPhotonClear | 1u << kPhotonShade | 1u << kPhotonLink | 1u << kPhotonGather;

// Meaning of BufferDimensions here. `options`: light vertices that a path stores at most. `pixels`: of a picture with
// photons, else 0.
enum OwnBuffer : std::size_t {
  kConstants,
  kWeights,
  kVertices,
  kCounts,
  kConnections,
  kConnectionQueue,
  kPhotonConstants,
  kPhotons,
  kPhotonCells,
  kMergeWeights
};
const std::vector<BufferRule> kRules = {
    {"constants",
     [](const BufferDimensions&) { return std::uint64_t{sizeof(gpu::BidirectionalFrame)}; },
     {{gpu::kBindBidirectional, BindingKind::uniform}}},
    {"path weights",
     [](const BufferDimensions& e) { return e.slots * sizeof(gpu::PathWeights); },
     {{gpu::kBindPathWeights, BindingKind::storage}}},
    {"light vertices",
     [](const BufferDimensions& e) { return e.slots * e.options * sizeof(gpu::LightVertex); },
     {{gpu::kBindLightVertices, BindingKind::storage}, {gpu::kBindLightVertexTexels, BindingKind::texels_rgba32ui}}},
    {"light vertex counts",
     [](const BufferDimensions& e) { return e.slots * sizeof(std::uint32_t); },
     {{gpu::kBindLightCounts, BindingKind::storage}}},
    {"connections",
     [](const BufferDimensions& e) { return e.slots * sizeof(gpu::Connection); },
     {{gpu::kBindConnections, BindingKind::storage}, {gpu::kBindConnectionTexels, BindingKind::texels_rgba32ui}}},
    {"connection queue",
     [](const BufferDimensions&) { return std::uint64_t{sizeof(gpu::ConnectionQueue)}; },
     {{gpu::kBindConnectionQueue, BindingKind::storage}}},
    {"photon constants",
     [](const BufferDimensions&) { return std::uint64_t{sizeof(gpu::PhotonFrame)}; },
     {{gpu::kBindPhotonFrame, BindingKind::uniform}}},
    {"photons",
     [](const BufferDimensions& e) { return e.pixels ? plan_photons(e.pixels).photons() * sizeof(gpu::Photon) : 0; },
     {{gpu::kBindPhotons, BindingKind::storage}, {gpu::kBindPhotonTexels, BindingKind::texels_rgba32ui}}},
    {"photon cells",
     [](const BufferDimensions& e) {
       return e.pixels ? plan_photons(e.pixels).cell_count * sizeof(gpu::PhotonCell) : 0;
     },
     {{gpu::kBindPhotonCells, BindingKind::storage}, {gpu::kBindPhotonCellTexels, BindingKind::texels_rg32ui}}},
    {"merge weights",
     [](const BufferDimensions& e) { return e.pixels ? e.slots * sizeof(float) : 0; },
     {{gpu::kBindMergeWeights, BindingKind::storage}}},
};

std::vector<Binding> layout() {
  std::vector<Binding> layout = path_layout();
  add_layout(kRules, layout);
  layout.push_back({gpu::kBindSplats, BindingKind::storage, nullptr});
  return layout;
}

// Vertices that can be connected to: the last surface of a path is reached from the camera's side.
std::uint32_t stored_vertices(const RenderPlan& settings) {
  return settings.techniques & gpu::kTechniqueConnect && settings.max_depth > 0 ? settings.max_depth - 1 : 0;
}

gpu::BidirectionalFrame make_frame(const PackedScene& scene, const gpu::Frame& frame, std::uint32_t techniques,
                                   bool lamps_in_bodies) {
  constexpr float kMargin = 1.001f; // for rounding: no light from infinity may begin inside the scene
  const float pixels = static_cast<float>(frame.width) * static_cast<float>(frame.height);
  const float eyes = frame.eyes == gpu::kEyesOne ? 1.0f : 2.0f; // each has half of the pixels, and of the light paths
  return {.scene_centre = scene.centre,
          .scene_radius = std::max(static_cast<float>(scene.radius), 1e-6f) * kMargin,
          .pixel_area = 4.0f * glm::length(glm::cross(frame.camera_right, frame.camera_up)) / (pixels / eyes),
          .light_paths = pixels / eyes,
          .techniques = techniques,
          .lamps_in_bodies = lamps_in_bodies ? 1u : 0u};
}

} // namespace

std::uint64_t light_vertex_bytes_per_slot(const RenderPlan& settings) {
  return stored_vertices(settings) * sizeof(gpu::LightVertex);
}

std::uint64_t light_bytes_per_slot(const RenderPlan& settings, bool merges) {
  std::uint64_t bytes = 0;
  for (const BufferRule& rule : kRules) {
    const auto of = [&](std::uint64_t slots) {
      return rule.bytes({.pixels = merges ? 1u : 0u, .slots = slots, .options = stored_vertices(settings)});
    };
    bytes += of(1) - of(0);
  }
  return bytes;
}

const KernelProgram kBidirectionalProgram = {kStages, kCompileOrder, layout};

KernelNeed bidirectional_need(const KernelConfig& config) {
  constexpr std::uint32_t kAlways = (1u << kPhotonClear) - 1u;
  const bool has_volume = (config.features & gpu::kFeatureVoxels) != 0;
  return {&kBidirectionalProgram, kAlways | (has_volume ? 1u << kCameraCollide : 0), config};
}

Bidirectional::Bidirectional(Workspace& workspace, KernelCompiler& kernels)
    : workspace_(workspace),
      kernels_(kernels),
      paths_(workspace, kernels),
      trainer_(workspace, kernels, paths_),
      buffers_(workspace.device, kRules),
      delta_surfaces_(find_delta_surfaces(workspace.scene)),
      lamps_in_bodies_(lamps_in_bodies(workspace.scene)) {}

void Bidirectional::change(const View& view, const RenderPlan& settings, TemporalHistory) {
  const PackedScene& scene = workspace_.scene;
  refuse_lobes(scene, kBidirectionalLacks, "bidirectional");
  need_ = bidirectional_need(kernel_config(needed_features(scene, view, settings), scene.stack_size, settings));
  kernels_.start(need_);
  // Photons pass smooth surfaces, not smooth coats; what only one of the two finds must not be shared.
  const bool coated = (scene.features & gpu::kLobeCoat) != 0;
  const bool merges =
      asks_for_photons(settings) && !coated && delta_surfaces_.area > 0.0 && workspace_.frame.light_count > 0;
  techniques_ = merges ? settings.techniques : settings.techniques & ~gpu::kTechniqueMerge;
  photons_ = merges ? plan_photons(std::uint64_t{settings.width} * settings.height) : PhotonPlan{};
  first_radius_ = merges ? first_radius(workspace_.frame, delta_surfaces_) : 0.0f;
  first_block_ = merges ? std::optional(settings.first_sample / photons_.block) : std::nullopt;
  block_.reset();
  photon_need_ = need_;
  photon_need_.stages = kPhotonStages;
  if (merges) kernels_.start(photon_need_);
  const gpu::Feature features = kernels_.features(kBidirectionalProgram);
  trainer_.change(settings);
  is_training_ = trainer_.trains();
  bool moved = paths_.change(settings, kSharedPathStages, kCapacityForShadowRays | trainer_.capacity(), features);
  trainer_.start();
  const std::uint64_t photon_pixels = merges ? std::uint64_t{settings.width} * settings.height : 0;
  moved |= buffers_.fit({.pixels = photon_pixels, .slots = workspace_.slots, .options = stored_vertices(settings)});
  send_constants(techniques_);
  if (!moved && !sets_.empty()) return;
  sets_.clear();
  for (const FilmBand& band : workspace_.film.bands()) {
    std::vector<Binding> bindings = workspace_.bindings(band);
    paths_.buffers.add_bindings(bindings);
    paths_.add_cover_binding(bindings);
    buffers_.add_bindings(bindings);
    bindings.push_back({gpu::kBindSplats, BindingKind::storage, &band.splats});
    sets_.push_back(
        std::make_unique<BindingSet>(workspace_.device, bindings, static_cast<std::uint32_t>(sizeof(gpu::Wave))));
  }
}

void Bidirectional::send_constants(std::uint32_t techniques) {
  const gpu::BidirectionalFrame frame = make_frame(workspace_.scene, workspace_.frame, techniques, lamps_in_bodies_);
  buffers_[kConstants].write(&frame, sizeof(frame));
}

bool Bidirectional::is_ready() {
  const bool paths = paths_.is_ready(); // asks for both, so that both are begun
  const bool photons = !merges() || kernels_.ready(photon_need_), pilot = trainer_.is_ready();
  return kernels_.ready(need_) && paths && photons && pilot;
}

double Bidirectional::get_ready() {
  const double photons = merges() ? kernels_.best(photon_need_).seconds() : 0.0;
  return kernels_.best(need_).seconds() + paths_.get_ready() + photons + trainer_.get_ready();
}

// Training uses camera paths alone, weighted as in path tracing. Weighted as in the picture, where light paths find
// much of the light, they train worse: 1.09x the squared error (a house with 10,000 lamps) and 1.29x (100 lamps).
std::optional<Pilot> Bidirectional::pilot() {
  if (!is_training_) return std::nullopt;
  send_constants(techniques_ & (gpu::kTechniqueHit | gpu::kTechniqueLight));
  return trainer_.begin();
}

bool Bidirectional::end_pilot() {
  trainer_.finish();
  is_training_ = false;
  send_constants(techniques_);
  return false;
}

// Passes end where blocks do, so that all samples of a wave share a map.
std::uint32_t Bidirectional::most_samples(std::uint32_t first_sample) const {
  const std::uint32_t most = Integrator::most_samples(first_sample);
  return merges() ? std::min(most, photons_.block - first_sample % photons_.block) : most;
}

void Bidirectional::begin_pass(WaveQueue& queue, std::uint32_t first_sample) {
  if (is_training_ || !merges() || block_ == first_sample / photons_.block) return;
  block_ = first_sample / photons_.block;
  const gpu::PhotonFrame map = photon_frame(photons_, radius_of_block(first_radius_, photons_, *block_));
  queue.submit([&](Commands& commands) { record_empty_map(commands, map); }, {.timed_dispatches = 1});
  const std::uint32_t most = std::min(workspace_.slots, kPhotonWave);
  gpu::Wave wave{.sample_count = 1, .first_film_pixel = gpu::kNone}; // see traces_photons()
  for (std::uint32_t replicate = 0; replicate < gpu::kReplicates; ++replicate) {
    wave.first_sample = *block_ * gpu::kReplicates + replicate;
    for (wave.first_pixel = 0; wave.first_pixel < photons_.path_count; wave.first_pixel += wave.pixel_count) {
      wave.pixel_count = std::min(most, photons_.path_count - wave.first_pixel);
      queue.submit([&](Commands& commands) { record_photons(commands, wave); },
                   {.timed_dispatches = timed_dispatches()});
    }
  }
  queue.submit([&](Commands& commands) { record_links(commands, wave); }, {.timed_dispatches = 1});
}

void Bidirectional::describe(RenderResult& result) const {
  result.light_training = trainer_.report();
  if (!merges() || !block_) return;
  result.merging = {.first_radius = radius_of_block(first_radius_, photons_, *first_block_),
                    .last_radius = radius_of_block(first_radius_, photons_, *block_),
                    .photon_paths = photons_.path_count,
                    .block = photons_.block,
                    .bytes = photons_.bytes()};
}

void Bidirectional::record_empty_map(Commands& commands, const gpu::PhotonFrame& map) {
  const gpu::Wave wave{};
  commands.write(buffers_[kPhotonConstants], &map, sizeof(map));
  commands.bind(*sets_[0]);
  commands.dispatch(kernels_.best(photon_need_)[kPhotonClear], groups_for(photons_.cell_count), &wave);
}

void Bidirectional::record_photons(Commands& commands, const gpu::Wave& wave) {
  const KernelSet &kernels = kernels_.best(need_), &photon_kernels = kernels_.best(photon_need_);
  commands.bind(*sets_[0]);
  commands.dispatch(kernels[kLightGenerate], groups_for(wave.pixel_count), &wave);
  gpu::Wave step = wave;
  for (std::uint32_t bounce = 1; bounce < workspace_.frame.max_depth; ++bounce) {
    commands.barrier();
    commands.bind(paths_.bindings(0));
    step.bounce = gpu::kAdvanceSteps * bounce + gpu::kBeforeExtend;
    commands.dispatch(paths_.kernels()[kAdvance], 1, &step);
    commands.bind(*sets_[0]);
    commands.barrier();
    step.bounce = bounce;
    commands.dispatch_indirect(kernels[kLightExtend], paths_.buffers[kQueues], offsetof(gpu::Queues, extend_groups),
                               &step);
    commands.barrier();
    commands.dispatch_indirect(photon_kernels[kPhotonShade], paths_.buffers[kQueues],
                               offsetof(gpu::Queues, extend_groups), &step);
  }
}

void Bidirectional::record_links(Commands& commands, const gpu::Wave& wave) {
  commands.bind(*sets_[0]);
  commands.dispatch(kernels_.best(photon_need_)[kPhotonLink], groups_for(photons_.photons()), &wave);
}

std::uint32_t Bidirectional::timed_dispatches() const {
  return std::min(4 + (workspace_.frame.max_depth + 1) * 17, 1024u);
}

void Bidirectional::record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) {
  constexpr std::uint32_t kLightTechniques = gpu::kTechniqueConnect | gpu::kTechniqueSplat;
  const bool lights = workspace_.frame.light_count > 0 && workspace_.frame.max_depth > 0 && !is_training_;
  if (lights && techniques_ & kLightTechniques) {
    record_light_paths(commands, band, wave);
    commands.barrier();
  }
  record_camera_paths(commands, band, wave);
}

void Bidirectional::record_light_paths(Commands& commands, std::size_t band, const gpu::Wave& wave) {
  const KernelSet &kernels = kernels_.best(need_), &path_kernels = paths_.kernels();
  const bool splats = techniques_ & gpu::kTechniqueSplat;
  gpu::Wave step = wave;
  commands.bind(*sets_[band]);
  commands.dispatch(kernels[kLightGenerate], groups_for(std::uint64_t{wave.pixel_count} * wave.sample_count), &wave);
  for (std::uint32_t bounce = 1; bounce <= workspace_.frame.max_depth; ++bounce) {
    commands.barrier();
    commands.bind(paths_.bindings(band));
    step.bounce = gpu::kAdvanceSteps * bounce + gpu::kBeforeExtend;
    commands.dispatch(path_kernels[kAdvance], 1, &step);
    commands.bind(*sets_[band]);
    step.bounce = 0;
    commands.dispatch(kernels[kConnectionAdvance], 1, &step);
    commands.barrier();
    step.bounce = bounce;
    const auto over_rays = [&](Stage stage) {
      commands.dispatch_indirect(kernels[stage], paths_.buffers[kQueues], offsetof(gpu::Queues, extend_groups), &step);
    };
    over_rays(kLightExtend);
    commands.barrier();
    over_rays(kLightShade);
    if (splats) record_splats(commands, band, step, kernels);
  }
}

// Light lands anywhere in the picture, so that every band of the film is offered it.
void Bidirectional::record_splats(Commands& commands, std::size_t band, const gpu::Wave& wave,
                                  const KernelSet& kernels) {
  commands.barrier();
  commands.dispatch(kernels[kConnectionAdvance], 1, &wave);
  commands.barrier();
  const std::vector<FilmBand>& bands = workspace_.film.bands();
  for (std::size_t i = 0; i < bands.size(); ++i) {
    if (bands[i].pixel_count == 0) continue;
    gpu::Wave to_band = wave;
    to_band.first_film_pixel = bands[i].first_pixel;
    to_band.sample_count = bands[i].pixel_count; // see light_splat.comp
    commands.bind(*sets_[i]);
    commands.dispatch_indirect(kernels[kLightSplat], buffers_[kConnectionQueue], offsetof(gpu::ConnectionQueue, groups),
                               &to_band);
  }
  commands.bind(*sets_[band]);
}

void Bidirectional::record_camera_paths(Commands& commands, std::size_t band, const gpu::Wave& wave) {
  const KernelSet &kernels = kernels_.best(need_), &path_kernels = paths_.kernels();
  const KernelSet& connecting = is_training_ ? trainer_.kernels() : path_kernels;
  const std::uint32_t bounces = workspace_.frame.max_depth + 1;
  const bool lights = workspace_.frame.light_count > 0;
  const BindingSet &own = *sets_[band], &shared = paths_.bindings(band);
  gpu::Wave step = wave;
  commands.bind(shared);
  commands.dispatch(path_kernels[kGenerate], groups_for(std::uint64_t{wave.pixel_count} * wave.sample_count), &wave);
  for (std::uint32_t bounce = 0; bounce < bounces; ++bounce) {
    paths_.extend(commands, path_kernels, wave, bounce);
    commands.bind(own);
    step.bounce = 0;
    commands.dispatch(kernels[kConnectionAdvance], 1, &step);
    commands.barrier();
    step.bounce = bounce;
    if (need_.config.features & gpu::kFeatureVoxels) {
      commands.dispatch_indirect(kernels[kCameraCollide], paths_.buffers[kQueues], offsetof(gpu::Queues, extend_groups),
                                 &step);
      commands.barrier();
    }
    if (merges() && !is_training_ && bounce > 0 &&
        bounce + 2 <= workspace_.frame.max_depth) { // a photon has met two surfaces
      commands.dispatch_indirect(kernels_.best(photon_need_)[kPhotonGather], paths_.buffers[kQueues],
                                 offsetof(gpu::Queues, extend_groups), &step);
      commands.barrier();
    }
    commands.dispatch_indirect(kernels[kCameraShade], paths_.buffers[kQueues], offsetof(gpu::Queues, extend_groups),
                               &step);
    if (bounce + 1 < bounces && lights && !is_training_ && techniques_ & gpu::kTechniqueConnect) {
      commands.barrier();
      step.bounce = 1; // any but 0
      commands.dispatch(kernels[kConnectionAdvance], 1, &step);
      commands.barrier();
      step.bounce = bounce;
      commands.dispatch_indirect(kernels[kCameraConnect], buffers_[kConnectionQueue],
                                 offsetof(gpu::ConnectionQueue, groups), &step);
    }
    commands.bind(shared);
    if (bounce + 1 < bounces && lights && techniques_ & gpu::kTechniqueLight)
      paths_.connect(commands, connecting, wave, bounce);
  }
  if (is_training_) return; // its samples do not reach the film
  commands.barrier();
  commands.dispatch(path_kernels[kAccumulate], groups_for(wave.pixel_count), &wave);
}

} // namespace wavepath
