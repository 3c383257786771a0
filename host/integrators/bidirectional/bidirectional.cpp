#include "host/integrators/bidirectional/bidirectional.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "kernels/bidirectional/bidirectional_connect.spv.h"
#include "kernels/bidirectional/bidirectional_shade.spv.h"
#include "kernels/bidirectional/connection_advance.spv.h"
#include "kernels/bidirectional/light_extend.spv.h"
#include "kernels/bidirectional/light_generate.spv.h"
#include "kernels/bidirectional/light_shade.spv.h"
#include "kernels/bidirectional/light_splat.spv.h"

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
  kStageCount
};
const std::array<KernelCode, kStageCount> kStages = {{{"light generate", wavepath_light_generate_spv},
                                                      {"light extend", wavepath_light_extend_spv},
                                                      {"light shade", wavepath_light_shade_spv},
                                                      {"light splat", wavepath_light_splat_spv},
                                                      {"bidirectional shade", wavepath_bidirectional_shade_spv},
                                                      {"bidirectional connect", wavepath_bidirectional_connect_spv},
                                                      {"connection advance", wavepath_connection_advance_spv}}};
constexpr std::array<std::size_t, kStageCount> kCompileOrder = {
    kCameraShade, kLightShade, kLightExtend, kLightSplat, kCameraConnect, kLightGenerate, kConnectionAdvance};

// `options` of the extents: light vertices that a path stores at most.
enum OwnBuffer : std::size_t { kConstants, kWeights, kVertices, kCounts, kConnections, kConnectionQueue };
const std::vector<BufferRule> kRules = {
    {"constants",
     [](const Extent&) { return std::uint64_t{sizeof(gpu::BidirectionalFrame)}; },
     {{gpu::kBindBidirectional, BindingKind::uniform}}},
    {"path weights",
     [](const Extent& e) { return e.slots * sizeof(gpu::PathWeights); },
     {{gpu::kBindPathWeights, BindingKind::storage}}},
    {"light vertices",
     [](const Extent& e) { return e.slots * e.options * sizeof(gpu::LightVertex); },
     {{gpu::kBindLightVertices, BindingKind::storage}, {gpu::kBindLightVertexTexels, BindingKind::texels_rgba32ui}}},
    {"light vertex counts",
     [](const Extent& e) { return e.slots * sizeof(std::uint32_t); },
     {{gpu::kBindLightCounts, BindingKind::storage}}},
    {"connections",
     [](const Extent& e) { return e.slots * sizeof(gpu::Connection); },
     {{gpu::kBindConnections, BindingKind::storage}, {gpu::kBindConnectionTexels, BindingKind::texels_rgba32ui}}},
    {"connection queue",
     [](const Extent&) { return std::uint64_t{sizeof(gpu::ConnectionQueue)}; },
     {{gpu::kBindConnectionQueue, BindingKind::storage}}},
};

std::vector<Binding> layout() {
  std::vector<Binding> layout = path_layout();
  add_layout(kRules, layout);
  layout.push_back({gpu::kBindSplats, BindingKind::storage, nullptr});
  return layout;
}

// Vertices that can be connected to: the last surface of a path is reached from the camera's side.
std::uint32_t stored_vertices(const RenderSettings& settings) {
  return settings.techniques & gpu::kTechniqueConnect && settings.max_depth > 0 ? settings.max_depth - 1 : 0;
}

gpu::BidirectionalFrame make_frame(const PackedScene& scene, const gpu::Frame& frame, std::uint32_t techniques) {
  constexpr float kMargin = 1.001f; // for rounding: no light from infinity may begin inside the scene
  const float pixels = static_cast<float>(frame.width) * static_cast<float>(frame.height);
  return {.scene_centre = scene.centre,
          .scene_radius = std::max(static_cast<float>(scene.radius), 1e-6f) * kMargin,
          .pixel_area = 4.0f * glm::length(glm::cross(frame.camera_right, frame.camera_up)) / pixels,
          .light_paths = pixels,
          .techniques = techniques};
}

} // namespace

std::uint64_t light_vertex_bytes_per_slot(const RenderSettings& settings) {
  return stored_vertices(settings) * sizeof(gpu::LightVertex);
}

std::uint64_t light_bytes_per_slot(const RenderSettings& settings) {
  std::uint64_t bytes = 0;
  for (const BufferRule& rule : kRules) bytes += rule.bytes({.slots = 1, .options = stored_vertices(settings)});
  return bytes - sizeof(gpu::BidirectionalFrame) - sizeof(gpu::ConnectionQueue);
}

const KernelProgram kBidirectionalProgram = {kStages, kCompileOrder, layout};

Bidirectional::Bidirectional(Workspace& workspace, KernelCompiler& kernels)
    : workspace_(workspace), kernels_(kernels), paths_(workspace, kernels), buffers_(workspace.device, kRules) {}

void Bidirectional::change(const View& view, const RenderSettings& settings, Past) {
  const PackedScene& scene = workspace_.scene;
  need_ = {&kBidirectionalProgram, kBidirectionalStages,
           kernel_config(needed_features(scene, view, settings), scene.stack_size, settings)};
  kernels_.start(need_);
  techniques_ = settings.techniques;
  const std::uint32_t features = kernels_.features(kBidirectionalProgram);
  bool moved = paths_.change(settings, kSharedPathStages, kRoomForShadowRays, features);
  moved |= buffers_.fit({.slots = workspace_.slots, .options = stored_vertices(settings)});
  const gpu::BidirectionalFrame frame = make_frame(scene, workspace_.frame, techniques_);
  buffers_[kConstants].write(&frame, sizeof(frame));
  if (!moved && !sets_.empty()) return;
  sets_.clear();
  for (const FilmBand& band : workspace_.film.bands()) {
    std::vector<Binding> bindings = workspace_.bindings(band);
    paths_.buffers.add_bindings(bindings);
    buffers_.add_bindings(bindings);
    bindings.push_back({gpu::kBindSplats, BindingKind::storage, &band.splats});
    sets_.push_back(
        std::make_unique<BindingSet>(workspace_.device, bindings, static_cast<std::uint32_t>(sizeof(gpu::Wave))));
  }
}

bool Bidirectional::is_ready() {
  const bool paths = paths_.is_ready(); // asks for both, so that both are begun
  return kernels_.ready(need_) && paths;
}

double Bidirectional::get_ready() { return kernels_.best(need_).seconds() + paths_.get_ready(); }

std::uint32_t Bidirectional::timed_dispatches() const {
  return std::min(4 + (workspace_.frame.max_depth + 1) * 16, 1024u);
}

void Bidirectional::record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) {
  constexpr std::uint32_t kLightTechniques = gpu::kTechniqueConnect | gpu::kTechniqueSplat;
  if (workspace_.frame.light_count > 0 && workspace_.frame.max_depth > 0 && techniques_ & kLightTechniques) {
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
    step.bounce = 2 * bounce;
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
    commands.dispatch_indirect(kernels[kCameraShade], paths_.buffers[kQueues], offsetof(gpu::Queues, extend_groups),
                               &step);
    if (bounce + 1 < bounces && lights && techniques_ & gpu::kTechniqueConnect) {
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
      paths_.connect(commands, path_kernels, wave, bounce);
  }
  commands.barrier();
  commands.dispatch(path_kernels[kAccumulate], groups_for(wave.pixel_count), &wave);
}

} // namespace wavepath
