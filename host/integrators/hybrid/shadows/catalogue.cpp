#include "host/integrators/hybrid/shadows/catalogue.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/sources.h"
#include "host/render/settings/settings_table.h"
#include "host/render/settings/shadow_settings.h"
#include "kernels/hybrid/shadows/shadow_types.h"

namespace wavepath {
namespace {

constexpr std::array kKinds = {&kShadowMap,    &kShadowMapId,    &kShadowPcf,        &kShadowPcss,    &kShadowVsm,
                               &kShadowEsm,    &kShadowEvsm,     &kShadowMoment,     &kShadowVssm,    &kShadowAverage,
                               &kShadowLeak,   &kShadowCascades, &kShadowSdsm,       &kShadowLispsm,  &kShadowTsm,
                               &kShadowPsm,    &kShadowCube,     &kShadowParaboloid, &kShadowVirtual, &kShadowIzb,
                               &kShadowPlanar, &kShadowLightmap, &kShadowProjected,  &kShadowZpass,   &kShadowZfail};
static_assert(kKinds.size() + 1 == kShadowNames.size());

} // namespace

std::span<const ShadowKind* const> shadow_kinds() { return kKinds; }

const ShadowKind* shadow_kind(const RenderPlan& settings) {
  const std::string_view name = kShadowNames[settings.shadows];
  const auto found = std::ranges::find_if(kKinds, [&](const ShadowKind* kind) { return kind->name == name; });
  return found == kKinds.end() ? nullptr : *found;
}

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

std::string unfit(const ShadowKind& kind, const PackedScene& scene) {
  const LightCover cover = light_cover(kind, scene);
  if (!cover.covered.empty()) return kind.refusal ? kind.refusal(scene) : "";
  return fmt::format("is for {}, and this scene has {}", names_of(kind.sources),
                     cover.traced.empty() ? "no light" : cover.traced);
}

std::vector<ShadowSource> covered_sources(const ShadowKind& kind, const PackedScene& scene) {
  if (const std::string problem = unfit(kind, scene); !problem.empty())
    throw Error(fmt::format("--shadows {}", kind.name), problem, "use --shadows traced");
  return light_cover(kind, scene).covered;
}

bool takes_shadow_setting(const RenderPlan& settings, std::string_view setting) {
  if (!setting.starts_with("shadow-") || setting == "shadow-samples") return true;
  const ShadowKind* kind = shadow_kind(settings);
  return kind && (setting == "shadow-ambient" || std::ranges::count(kind->settings, setting) > 0);
}

void check_shadow_settings(const RenderPlan& settings) {
  const std::string technique(kShadowNames[settings.shadows]);
  if (settings.direct == gpu::kDirectBsdf && settings.shadows != kShadowsTraced)
    throw UsageError("--direct bsdf", fmt::format("sends no shadow rays, which --shadows {} is to answer", technique),
                     "leave one of them out");
  const bool midpoint = settings.shadow_bias == gpu::kBiasMidpoint,
             second = settings.shadow_bias == gpu::kBiasSecondDepth;
  const std::string bias = fmt::format("--shadow-bias {}", kShadowBiasNames[settings.shadow_bias]);
  if ((midpoint || second) && settings.shadow_source == kShadowSourceTraced)
    throw UsageError(bias, "needs surfaces behind the nearest, which --shadow-source traced does not find",
                     "leave one of them out");
  constexpr std::uint32_t kMostBakedTaps = 64; // of one texel, whose rays are one lane's: drivers end long loops
  if (technique == "lightmap" && settings.shadow_taps > kMostBakedTaps)
    throw UsageError("--shadow-taps", fmt::format("is at most {} for --shadows lightmap", kMostBakedTaps),
                     "give fewer");
  if (midpoint && technique == "virtual")
    throw UsageError(bias, "draws maps twice, and --shadows virtual draws its pages once", "use another bias");
  for (const Setting& row : settings_table())
    if (!is_default(row, settings) && !takes_shadow_setting(settings, row.name))
      throw UsageError(fmt::format("--{}", row.name), fmt::format("is not taken by --shadows {}", technique),
                       "leave it out");
}

} // namespace wavepath
