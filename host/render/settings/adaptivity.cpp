#include "host/render/settings/adaptivity.h"

#include "host/render/settings/integrator_kind.h"

namespace wavepath {

bool is_adaptive(const RenderPlan& settings) {
  const bool tries = settings.adaptive == kAdaptiveAuto && settings.looks_for_noise;
  return supports(*settings.integrator, "adaptive") && (tries || settings.adaptive == kAdaptiveOn);
}

} // namespace wavepath
