#include "host/integrators/hybrid/bounce/catalogue.h"

#include "host/integrators/hybrid/bounce/kinds.h"
#include "host/integrators/hybrid/reflections/catalogue.h"

namespace wavepath {

constinit const Registry<ReflectionKind> kBounceTechniques = {
    .setting = "bounce", .value = &RenderPlan::bounce, .rows = kBounceKinds, .built_in = "none"};

std::vector<Setting> bounce_rows() {
  static const std::vector<std::string_view> names = kBounceTechniques.names();
  return {{.name = "bounce",
           .value = ChoiceValue{&RenderSettings::bounce, names},
           .meaning = "light of one diffuse bounce, in the place of the ambient term. none: the ambient term. "
                      "traced: by rays, one for each light sample. cones: by --ao-samples cones through voxels",
           .placeholder = "NAME",
           .label = "bounce",
           .study = names}};
}

void check_bounce_settings(const RenderPlan& settings) {
  kBounceTechniques.check(settings);
  if (!kBounceTechniques.find(settings)) return;
  const std::string flag = fmt::format("--bounce {}", kBounceTechniques.name(settings));
  if (settings.max_depth <= 1)
    throw UsageError(flag, fmt::format("is light of two bounces, which --max-depth {} leaves out", settings.max_depth),
                     "leave one of them out");
  if (kReflectionTechniques.find(settings))
    throw UsageError(flag, "takes the place of mirrored rays, which --reflections sends", "leave one of them out");
  if (settings.occlusion != 0 || settings.ambient)
    throw UsageError(flag,
                     fmt::format("takes the place of the ambient term, which --{} is about",
                                 settings.ambient ? "ambient" : "occlusion"),
                     "leave one of them out");
}

const ReflectionKind* reflecting_technique(const RenderPlan& settings) {
  const ReflectionKind* bounce = kBounceTechniques.find(settings);
  return bounce ? bounce : kReflectionTechniques.find(settings);
}

} // namespace wavepath
