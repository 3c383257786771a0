#include "host/integrators/hybrid/transparency/catalogue.h"

#include "host/integrators/hybrid/transparency/kinds.h"

namespace wavepath {

constinit const Registry<TransparencyKind> kTransparencyTechniques = {
    .setting = "transparency", .value = &RenderPlan::transparency, .rows = kTransparencyKinds, .built_in = "traced"};

void check_transparency_settings(const RenderPlan& settings) {
  const TransparencyKind* kind = kTransparencyTechniques.find(settings);
  if (kind && kind->layers && settings.direct == gpu::kDirectBsdf)
    throw UsageError("--direct bsdf",
                     fmt::format("samples no lights, by which --transparency {} lights layers", kind->name),
                     "leave one of them out");
  kTransparencyTechniques.check(settings);
}

} // namespace wavepath
