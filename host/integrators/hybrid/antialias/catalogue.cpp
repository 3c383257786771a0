#include "host/integrators/hybrid/antialias/catalogue.h"

#include "host/integrators/hybrid/antialias/kinds.h"
#include "host/render/settings/antialias_settings.h"
#include "kernels/hybrid/hybrid_types.h"

namespace wavepath {

static_assert(kAntialiasKinds[kAntialiasTaaName] == &kAntialiasTaa);
static_assert(kAntialiasKinds[kAntialiasUpscaleName] == &kAntialiasUpscale);

constinit const Registry<AntialiasKind> kAntialiasTechniques = {
    .setting = "antialias", .value = &RenderPlan::antialias, .rows = kAntialiasKinds};

void check_antialias_settings(const RenderPlan& settings) {
  const AntialiasKind& kind = *kAntialiasTechniques.find(settings);
  const bool usual_filter = settings.filter == RenderPlan{}.filter || settings.filter == gpu::kFilterBox;
  if (kind.position && !usual_filter)
    throw UsageError("--filter", fmt::format("is not supported by --antialias {}", kind.name), "leave it out");
  if (kind.check) kind.check(settings);
}

} // namespace wavepath
