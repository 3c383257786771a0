#include "host/integrators/hybrid/occlusion/catalogue.h"

#include "host/integrators/hybrid/occlusion/kinds.h"

namespace wavepath {

constinit const Registry<OcclusionKind> kOcclusionTechniques = {
    .setting = "occlusion", .value = &RenderPlan::occlusion, .rows = kOcclusionKinds, .built_in = "traced"};

void check_occlusion_settings(const RenderPlan& settings) {
  kOcclusionTechniques.check(settings);
  if (!kOcclusionTechniques.find(settings)) return;
  const std::string flag = fmt::format("--occlusion {}", kOcclusionTechniques.name(settings));
  if (settings.ao_radius && *settings.ao_radius == 0.0)
    throw UsageError("--ao-radius 0", fmt::format("is unlimited, and {} looks no farther than a radius", flag),
                     "give one in metres, or leave it out");
  if (settings.integrator->finds_light && settings.max_depth <= 1)
    throw UsageError(flag, fmt::format("dims the ambient term, which --max-depth {} leaves out", settings.max_depth),
                     "leave one of them out");
}

} // namespace wavepath
