#include "host/render/settings/probing.h"

#include <algorithm>

#include "host/render/settings/denoising.h"
#include "host/render/settings/integrator_kind.h"

namespace wavepath {

bool has_error_probes(const RenderPlan& settings) {
  const IntegratorKind& kind = *settings.integrator;
  return kind.traces_paths && !kind.splats && !denoises_film(settings) &&
         std::ranges::find(settings.aovs, "variance") == settings.aovs.end() &&
         std::uint64_t{settings.width} * settings.height >= settings.probes_from;
}

} // namespace wavepath
