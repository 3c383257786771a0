#include "host/render/settings/adaptivity.h"

#include "host/render/settings/integrator_kind.h"

namespace wavepath {

// What stands for others begins as path.
bool can_be_adaptive(const RenderSettings& settings) {
  return takes(*settings.integrator, "adaptive") || settings.integrator->candidates;
}

bool is_adaptive(const RenderSettings& settings) {
  const bool tries = settings.adaptive == kAdaptiveAuto && settings.tries_adaptive;
  return can_be_adaptive(settings) && (tries || settings.adaptive == kAdaptiveOn);
}

} // namespace wavepath
