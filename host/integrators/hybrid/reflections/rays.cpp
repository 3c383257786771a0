#include "host/integrators/hybrid/reflections/rays.h"

#include <array>

#include "host/integrators/hybrid/reflections/mirror_planes.h"
#include "kernels/hybrid/reflections/reflect.spv.h"
#include "kernels/hybrid/reflections/reflect_answer.spv.h"
#include "kernels/hybrid/reflections/reflect_meet.spv.h"
#include "kernels/hybrid/reflections/reflect_nested.spv.h"
#include "kernels/hybrid/reflections/reflect_nested_queue.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, kRayStageCount> kRayStages = {
    {{"reflect", wavepath_reflect_spv},
     {"meet reflected", wavepath_reflect_meet_spv},
     {"answer reflected", wavepath_reflect_answer_spv},
     {"mirrors in mirrors", wavepath_reflect_nested_spv},
     {"queue of mirrors in mirrors", wavepath_reflect_nested_queue_spv}}};
constexpr std::array<std::size_t, kRayStageCount> kRayOrder = {kReflect, kNested, kMeet, kAnswer, kNestedQueue};

constexpr std::uint64_t kListHead = 4 * sizeof(std::uint32_t); // of kBindNestedRays

} // namespace

const KernelProgram kRayProgram = {kRayStages, kRayOrder, ray_layout};

std::vector<Binding> ray_layout() {
  std::vector<Binding> layout = reflection_layout();
  layout.push_back({gpu::kBindNestedRays, BindingKind::storage, nullptr});
  return layout;
}

void RayReflections::change(const View& view, const RenderPlan& settings, const KernelConfig& config,
                            const std::vector<Binding>& shared) {
  nests_ = reflection_depth(context_.kind, settings) > 1 && sees_nested(settings);
  const std::uint64_t rays = nests_ ? context_.workspace.slots : 0;
  reserve(context_.workspace.device, nested_rays_, kListHead + rays * sizeof(gpu::NestedRay));
  Reflections::change(view, settings, config, shared);
}

bool RayReflections::sees_nested(const RenderPlan& settings) {
  if (threshold_ != settings.reflection_threshold)
    faces_ = !lie_in_one_plane(context_.workspace.scene, settings.reflection_threshold);
  threshold_ = settings.reflection_threshold;
  return faces_;
}

void RayReflections::add_bindings(std::vector<Binding>& bindings) {
  bindings.push_back({gpu::kBindNestedRays, BindingKind::storage, &nested_rays_});
}

void RayReflections::record(Commands& commands, std::size_t band, const gpu::Wave& wave) {
  const KernelSet& own = kernels();
  const std::uint32_t slots = groups_for(std::uint64_t{wave.pixel_count} * wave.sample_count);
  const std::array<std::uint32_t, 2> empty{}; // Queues::ray_count
  commands.write(context_.paths.buffers[kQueues], empty.data(), sizeof(empty));
  commands.bind(bindings(band));
  gpu::Wave mirrored = wave;
  mirrored.bounce = mirrors();
  commands.dispatch(own[kReflect], slots, &mirrored);
  commands.barrier();
  find(commands, band, wave, 0);
  commands.barrier();
  if (nests_) {
    commands.write(nested_rays_, empty.data(), sizeof(std::uint32_t));
    commands.bind(bindings(band));
    commands.dispatch(own[kNested], slots, &mirrored);
    commands.barrier();
  }
  light_hits(commands, band, wave);
  if (nests_) {
    commands.bind(bindings(band));
    commands.dispatch(own[kNestedQueue], slots, &wave);
    commands.barrier();
    find(commands, band, wave, 1);
    commands.barrier();
    light_hits(commands, band, wave);
  }
  commands.bind(bindings(band));
  commands.dispatch(own[kAnswer], groups_for(wave.pixel_count), &wave);
}

void RayReflections::light_hits(Commands& commands, std::size_t band, const gpu::Wave& wave) {
  commands.bind(bindings(band));
  commands.dispatch(kernels()[kMeet], groups_for(std::uint64_t{wave.pixel_count} * wave.sample_count), &wave);
  commands.barrier();
  context_.light(commands, band, wave);
  commands.barrier();
}

void RayReflections::find(Commands& commands, std::size_t band, const gpu::Wave& wave, std::uint32_t) {
  commands.bind(context_.paths.bindings(band));
  context_.paths.extend(commands, context_.paths.kernels(), wave, gpu::kMirroredBounce);
}

// A ray knows what it meets.
ReflectionReport RayReflections::report() const {
  ReflectionReport report = Reflections::report();
  report.answered = report.asked;
  return report;
}

} // namespace wavepath
