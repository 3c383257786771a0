#include "host/integrators/hybrid/shadows/catalogue.h"

#include <array>

#include <fmt/format.h>

#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/sources.h"
#include "host/render/settings/shadow_settings.h"
#include "kernels/hybrid/shadows/shadow_types.h"

namespace wavepath {
namespace {

constexpr std::array<std::string_view, 1> kOfAllTechniques = {"shadow-ambient"};

} // namespace

constinit const Registry<ShadowKind> kShadowTechniques = {.setting = "shadows",
                                                          .value = &RenderPlan::shadows,
                                                          .rows = kShadowKinds,
                                                          .built_in = "traced",
                                                          .common = kOfAllTechniques};

LightCover light_cover(const ShadowKind& kind, const PackedScene& scene) {
  LightCover cover;
  std::vector<ShadowSource> others;
  std::size_t emitters = 0;
  bool environment = false;
  for (const gpu::Light& light : scene.lights) {
    emitters += light.kind == gpu::kLightTriangle;
    environment |= light.kind == gpu::kLightEnvironment;
  }
  for (ShadowSource& source : find_sources(scene)) {
    if (source.kind & kAreaSources) emitters -= source.lights.size();
    (source.kind & kind.sources ? cover.covered : others).push_back(std::move(source));
  }
  std::vector<std::string> traced;
  if (!others.empty()) traced.push_back(names_of(others));
  if (emitters > 0) traced.push_back(fmt::format("{} other emissive triangles", emitters));
  if (environment) traced.emplace_back("the environment");
  cover.traced = fmt::format("{}", fmt::join(traced, ", "));
  return cover;
}

std::string unsupported_reason(const ShadowKind& kind, const PackedScene& scene) {
  if (scene.features & gpu::kFeatureSoftLamps)
    return "is for lamps without an extent, or with that of emissive surfaces (--sun-angle, --lamp-radius)";
  const LightCover cover = light_cover(kind, scene);
  if (!cover.covered.empty()) return kind.refusal ? kind.refusal(scene) : "";
  return fmt::format("is for {}, and this scene has {}", names_of(kind.sources),
                     cover.traced.empty() ? "no light" : cover.traced);
}

std::vector<ShadowSource> covered_sources(const ShadowKind& kind, const PackedScene& scene) {
  if (const std::string problem = unsupported_reason(kind, scene); !problem.empty())
    throw Error(fmt::format("--shadows {}", kind.name), problem, "use --shadows traced");
  return light_cover(kind, scene).covered;
}

void check_shadow_settings(const RenderPlan& settings) {
  if (settings.direct == gpu::kDirectBsdf && settings.shadows != kShadowsTraced)
    throw UsageError(
        "--direct bsdf",
        fmt::format("sends no shadow rays, which --shadows {} is to answer", kShadowTechniques.name(settings)),
        "leave one of them out");
  const bool looks_behind = settings.shadow_bias == gpu::kBiasMidpoint || settings.shadow_bias == gpu::kBiasSecondDepth;
  if (looks_behind && settings.shadow_source == kShadowSourceTraced)
    throw UsageError(fmt::format("--shadow-bias {}", kShadowBiasNames[settings.shadow_bias]),
                     "needs surfaces behind the nearest, which --shadow-source traced does not find",
                     "leave one of them out");
  kShadowTechniques.check(settings);
}

} // namespace wavepath
