#include "host/integrators/hybrid/shading/catalogue.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/shading/kinds.h"
#include "host/render/settings/settings_table.h"
#include "host/render/settings/shading_settings.h"

namespace wavepath {
namespace {

constexpr std::array kKinds = {&kShadingLambert, &kShadingPhong, &kShadingBlinnPhong};
static_assert(kKinds.size() + 1 == kShadingNames.size());

} // namespace

const ShadingKind* shading_kind(const RenderPlan& settings) {
  const std::string_view name = kShadingNames[settings.shading];
  const auto found = std::ranges::find_if(kKinds, [&](const ShadingKind* kind) { return kind->name == name; });
  return found == kKinds.end() ? nullptr : *found;
}

bool takes_shading_setting(const RenderPlan& settings, std::string_view setting) {
  if (std::ranges::count(kShadingSettings, setting) == 0) return true;
  const ShadingKind* kind = shading_kind(settings);
  return kind && std::ranges::count(kind->settings, setting) > 0;
}

void check_shading_settings(const RenderPlan& settings) {
  const std::string model(kShadingNames[settings.shading]);
  if (settings.direct == gpu::kDirectBsdf && settings.shading != kShadingGltf)
    throw UsageError("--direct bsdf", fmt::format("draws directions, which --shading {} does not", model),
                     "leave one of them out");
  for (const Setting& row : settings_table())
    if (!is_default(row, settings) && !takes_shading_setting(settings, row.name))
      throw UsageError(fmt::format("--{}", row.name), fmt::format("is not taken by --shading {}", model),
                       "leave it out");
}

} // namespace wavepath
