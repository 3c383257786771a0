#include "host/integrators/whitted/whitted.h"
#include "host/scene/pack/features.h"

#include <algorithm>
#include <array>

#include "kernels/whitted/whitted_begin.spv.h"
#include "kernels/whitted/whitted_gather.spv.h"
#include "kernels/whitted/whitted_light.spv.h"
#include "kernels/whitted/whitted_light_layered.spv.h"
#include "kernels/whitted/whitted_light_layered_query.spv.h"
#include "kernels/whitted/whitted_light_query.spv.h"
#include "kernels/whitted/whitted_trace.spv.h"
#include "kernels/whitted/whitted_trace_layered.spv.h"
#include "kernels/whitted/whitted_trace_layered_query.spv.h"
#include "kernels/whitted/whitted_trace_query.spv.h"

namespace wavepath {
namespace {

enum Stage : std::size_t { kBegin, kTrace, kLight, kGather, kStageCount };
const std::array<KernelCode, kStageCount> kStages = {
    {{"whitted begin", wavepath_whitted_begin_spv},
     {"whitted trace", wavepath_whitted_trace_spv, wavepath_whitted_trace_layered_spv, wavepath_whitted_trace_query_spv,
      wavepath_whitted_trace_layered_query_spv},
     {"whitted light", wavepath_whitted_light_spv, wavepath_whitted_light_layered_spv, wavepath_whitted_light_query_spv,
      wavepath_whitted_light_layered_query_spv},
     {"whitted gather", wavepath_whitted_gather_spv}}};
constexpr std::array<std::size_t, kStageCount> kCompileOrder = {kLight, kTrace, kBegin, kGather};

enum OwnBuffer : std::size_t { kConstants, kNodes };
const std::vector<BufferRule> kRules = {
    {"constants",
     [](const BufferDimensions&) { return std::uint64_t{sizeof(gpu::WhittedFrame)}; },
     {{gpu::kBindWhitted, BindingKind::uniform}}},
    {"nodes of trees",
     [](const BufferDimensions& e) { return e.slots * sizeof(gpu::WhittedNode); },
     {{gpu::kBindWhittedNodes, BindingKind::storage}}},
};

std::vector<Binding> layout() {
  std::vector<Binding> layout = path_layout();
  add_layout(kRules, layout);
  return layout;
}

gpu::WhittedFrame make_frame(const PackedScene& scene, const RenderPlan& settings) {
  gpu::WhittedFrame frame{.ambient = settings.ambient.value_or(glm::vec3(0.0f)),
                          .cutoff = static_cast<float>(settings.cutoff),
                          .width = tree_width(settings)};
  frame.triangles =
      static_cast<std::uint32_t>(std::ranges::count(scene.lights, gpu::kLightTriangle, &gpu::Light::kind));
  frame.triangle_rays = std::min(frame.triangles, gpu::kMostTriangleRays);
  const bool sky = (scene.features & gpu::kFeatureEnvironment) && scene.environment_probability == 0.0f;
  frame.shadow_rays = frame.triangle_rays + static_cast<std::uint32_t>(scene.lights.size()) - frame.triangles + sky;
  return frame;
}

} // namespace

std::uint32_t tree_width(const RenderPlan& settings) {
  return settings.branching == kBranchingChoice ? 1 : gpu::kTreeWidth;
}

const KernelProgram kWhittedProgram = {kStages, kCompileOrder, layout};

Whitted::Whitted(Workspace& workspace, KernelCompiler& kernels)
    : workspace_(workspace), kernels_(kernels), paths_(workspace, kernels), buffers_(workspace.device, kRules) {}

void Whitted::change(const View& view, const RenderPlan& settings, TemporalHistory) {
  const PackedScene& scene = workspace_.scene;
  refuse_lobes(scene, kWhittedLacks, "whitted");
  need_ = {&kWhittedProgram, kWhittedStages,
           kernel_config(needed_features(scene, view, settings), scene.stack_size, settings)};
  kernels_.start(need_);
  const gpu::Feature features = kernels_.features(kWhittedProgram);
  bool moved = paths_.change(settings, stage_bits({kAccumulate}), kStatesAlone, features);
  moved |= buffers_.fit({.slots = workspace_.slots});
  const gpu::WhittedFrame frame = make_frame(scene, settings);
  width_ = frame.width, shadow_rays_ = frame.shadow_rays;
  buffers_[kConstants].write(&frame, sizeof(frame));
  if (!moved && !sets_.empty()) return;
  std::vector<Binding> own;
  paths_.buffers.add_bindings(own);
  buffers_.add_bindings(own);
  sets_ = bind_bands(workspace_, own);
}

bool Whitted::is_ready() {
  const bool film = paths_.is_ready(); // asks for both, so that both are begun
  return kernels_.ready(need_) && film;
}

double Whitted::get_ready() { return kernels_.best(need_).seconds() + paths_.get_ready(); }

std::uint32_t Whitted::light_passes() const { return (shadow_rays_ + gpu::kLightsAtOnce - 1) / gpu::kLightsAtOnce; }

std::uint32_t Whitted::timed_dispatches() const {
  return std::min(3 + (workspace_.frame.max_depth + 1) * (1 + light_passes()), 1024u);
}

void Whitted::record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) {
  const KernelSet& kernels = kernels_.best(need_);
  const std::uint64_t samples = gpu::level_slots(wave);
  const std::uint32_t groups = groups_for(samples * width_);
  commands.bind(*sets_[band]);
  commands.dispatch(kernels[kBegin], groups, &wave);
  gpu::Wave step = wave;
  for (step.bounce = 0; step.bounce <= workspace_.frame.max_depth; ++step.bounce) {
    commands.barrier();
    commands.dispatch(kernels[kTrace], groups, &step);
    if (step.bounce == workspace_.frame.max_depth) break; // the last rays only collect emission
    for (std::uint32_t pass = 0; pass < light_passes(); ++pass) {
      commands.barrier();
      step.first_film_pixel = pass * gpu::kLightsAtOnce; // the first light, see whitted_light.comp
      commands.dispatch(kernels[kLight], groups, &step);
    }
  }
  commands.barrier();
  commands.dispatch(kernels[kGather], groups_for(samples), &wave);
  commands.barrier();
  commands.bind(paths_.bindings(band));
  commands.dispatch(paths_.kernels()[kAccumulate], groups_for(wave.pixel_count), &wave);
}

} // namespace wavepath
