#include "host/integrators/hybrid/transparency/catalogue.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/transparency/kinds.h"
#include "host/render/settings/settings_table.h"
#include "host/render/settings/transparency_settings.h"

namespace wavepath {
namespace {

constexpr std::array kKinds = {&kTransparencySorted,     &kTransparencyPeel,       &kTransparencyWeighted,
                               &kTransparencyScreendoor, &kTransparencyStochastic, &kTransparencyRefractive};
static_assert(kKinds.size() + 1 == kTransparencyNames.size());

} // namespace

const TransparencyKind* transparency_kind(const RenderPlan& settings) {
  const std::string_view name = kTransparencyNames[settings.transparency];
  const auto found = std::ranges::find_if(kKinds, [&](const TransparencyKind* kind) { return kind->name == name; });
  return found == kKinds.end() ? nullptr : *found;
}

bool takes_transparency_setting(const RenderPlan& settings, std::string_view setting) {
  if (!setting.starts_with("transparency-")) return true;
  const TransparencyKind* kind = transparency_kind(settings);
  return kind && std::ranges::count(kind->settings, setting) > 0;
}

void check_transparency_settings(const RenderPlan& settings) {
  const TransparencyKind* kind = transparency_kind(settings);
  if (kind && kind->layers && settings.direct == gpu::kDirectBsdf)
    throw UsageError("--direct bsdf",
                     fmt::format("samples no lights, by which --transparency {} lights layers", kind->name),
                     "leave one of them out");
  for (const Setting& row : settings_table())
    if (!is_default(row, settings) && !takes_transparency_setting(settings, row.name))
      throw UsageError(fmt::format("--{}", row.name),
                       fmt::format("is not taken by --transparency {}", kTransparencyNames[settings.transparency]),
                       "leave it out");
}

} // namespace wavepath
