#include "host/integrators/hybrid/reflections/catalogue.h"

#include <array>

#include "host/integrators/hybrid/reflections/kinds.h"

namespace wavepath {
namespace {

constexpr std::array<std::string_view, 1> kCommon = {"reflection-threshold"};

} // namespace

constinit const Registry<ReflectionKind> kReflectionTechniques = {.setting = "reflections",
                                                                  .value = &RenderPlan::reflections,
                                                                  .rows = kReflectionKinds,
                                                                  .built_in = "none",
                                                                  .common = kCommon};

void check_reflection_settings(const RenderPlan& settings) {
  kReflectionTechniques.check(settings);
  if (!kReflectionTechniques.find(settings) || settings.max_depth > 1) return;
  throw UsageError(fmt::format("--reflections {}", kReflectionTechniques.name(settings)),
                   fmt::format("shows light of two bounces, which --max-depth {} leaves out", settings.max_depth),
                   "leave one of them out");
}

} // namespace wavepath
