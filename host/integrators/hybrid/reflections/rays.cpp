#include "host/integrators/hybrid/reflections/rays.h"

#include <array>

#include "kernels/hybrid/reflections/reflect.spv.h"
#include "kernels/hybrid/reflections/reflect_answer.spv.h"
#include "kernels/hybrid/reflections/reflect_meet.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, kRayStageCount> kRayStages = {{{"reflect", wavepath_reflect_spv},
                                                            {"meet reflected", wavepath_reflect_meet_spv},
                                                            {"answer reflected", wavepath_reflect_answer_spv}}};
constexpr std::array<std::size_t, kRayStageCount> kRayOrder = {kReflect, kMeet, kAnswer};

} // namespace

const KernelProgram kRayProgram = {kRayStages, kRayOrder, reflection_layout};

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
  find(commands, band, wave);
  commands.barrier();
  commands.bind(bindings(band));
  commands.dispatch(own[kMeet], slots, &wave);
  commands.barrier();
  context_.light(commands, band, wave);
  commands.barrier();
  commands.bind(bindings(band));
  commands.dispatch(own[kAnswer], groups_for(wave.pixel_count), &wave);
}

void RayReflections::find(Commands& commands, std::size_t band, const gpu::Wave& wave) {
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
