#include "host/render/settings/denoising.h"

#include <algorithm>

#include "host/render/settings/cover.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/pass_names.h"

namespace wavepath {

bool denoises_film(const RenderPlan& settings) {
  return settings.denoise != kDenoiseOff && settings.integrator->traces_paths;
}

bool records_aovs(const RenderPlan& settings) {
  const auto needs_none = [](std::string_view aov) { return is_pass(aov) || is_cover(aov); };
  return !std::ranges::all_of(settings.aovs, needs_none) || denoises_film(settings);
}

} // namespace wavepath
