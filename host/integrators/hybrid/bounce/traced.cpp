// One diffuse bounce by rays: the truth that cones are measured by. What the rays meet is lit as mirrored surfaces are.
#include <array>

#include "host/integrators/hybrid/bounce/kinds.h"
#include "host/integrators/hybrid/reflections/rays.h"
#include "kernels/hybrid/bounce/bounce.spv.h"
#include "kernels/hybrid/reflections/reflect_answer.spv.h"
#include "kernels/hybrid/reflections/reflect_meet.spv.h"

namespace wavepath {
namespace {

// The first stages of RayStage: a bounce is one ray deep.
const std::array<KernelCode, 3> kBounceStages = {{{"bounce", wavepath_bounce_spv},
                                                  {"meet bounced", wavepath_reflect_meet_spv},
                                                  {"answer bounced", wavepath_reflect_answer_spv}}};
constexpr std::array<std::size_t, 3> kBounceOrder = {kReflect, kMeet, kAnswer};
const KernelProgram kBounceProgram = {kBounceStages, kBounceOrder, ray_layout};

} // namespace

constinit const ReflectionKind kBounceTraced = {
    .name = "traced",
    .summary = "found by rays",
    .program = &kBounceProgram,
    .traces = true,
    .make = [](const ReflectionContext& context) -> std::unique_ptr<ReflectionTechnique> {
      return std::make_unique<RayReflections>(context);
    },
};

} // namespace wavepath
