#include "host/render/settings/denoising.h"

#include <algorithm>

#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/pass_names.h"

namespace wavepath {

bool denoises_film(const RenderPlan& settings) {
  return settings.denoise != kDenoiseOff && settings.integrator->traces_paths;
}

bool records_aovs(const RenderPlan& settings) {
  return !std::ranges::all_of(settings.aovs, is_pass) || denoises_film(settings);
}

} // namespace wavepath
