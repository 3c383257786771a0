#include "host/render/settings/denoising.h"

#include "host/render/settings/integrator_kind.h"

namespace wavepath {

bool denoises_film(const RenderPlan& settings) {
  return settings.denoise != kDenoiseOff && settings.integrator->traces_paths;
}

bool records_aovs(const RenderPlan& settings) { return !settings.aovs.empty() || denoises_film(settings); }

} // namespace wavepath
