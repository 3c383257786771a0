#include "host/integrators/shadows/technique.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/shadows/kinds.h"
#include "host/render/settings/settings_table.h"
#include "host/render/settings/shadow_settings.h"

namespace wavepath {
namespace {

constexpr std::array kKinds = {&kShadowMap,  &kShadowPcf,  &kShadowPcss,       &kShadowCascades,
                               &kShadowSdsm, &kShadowCube, &kShadowParaboloid, &kShadowLispsm,
                               &kShadowTsm,  &kShadowPsm,  &kShadowVirtual};
static_assert(kKinds.size() + 1 == kShadowNames.size());

} // namespace

std::span<const ShadowKind* const> shadow_kinds() { return kKinds; }

const ShadowKind* shadow_kind(const RenderSettings& settings) {
  const std::string_view name = kShadowNames[settings.shadows];
  const auto found = std::ranges::find_if(kKinds, [&](const ShadowKind* kind) { return kind->name == name; });
  return found == kKinds.end() ? nullptr : *found;
}

std::vector<ShadowSource> covered_sources(const ShadowKind& kind, const PackedScene& scene) {
  std::vector<ShadowSource> all = find_sources(scene), covered;
  for (ShadowSource& source : all)
    if (source.kind & kind.sources) covered.push_back(source);
  if (covered.empty())
    throw Error(fmt::format("--shadows {}", kind.name),
                fmt::format("is for {}, and this scene has {}", names_of(kind.sources), names_of(all)),
                "use --shadows traced");
  return covered;
}

void check_shadow_settings(const RenderSettings& settings) {
  const std::string technique(kShadowNames[settings.shadows]);
  const ShadowKind* kind = shadow_kind(settings);
  if (settings.direct == gpu::kDirectBsdf && kind)
    throw UsageError("--direct bsdf", fmt::format("sends no shadow rays, which --shadows {} is to answer", technique),
                     "leave one of them out");
  for (const Setting& row : settings_table()) {
    if (!row.name.starts_with("shadow-") || row.name == "shadow-samples" || is_default(row, settings)) continue;
    const bool taken = kind && (row.name == "shadow-ambient" || std::ranges::count(kind->settings, row.name) > 0);
    if (!taken)
      throw UsageError(fmt::format("--{}", row.name), fmt::format("is not taken by --shadows {}", technique),
                       "leave it out");
  }
}

} // namespace wavepath
