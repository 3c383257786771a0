#include "host/integrators/hybrid/occlusion/catalogue.h"

#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/occlusion/kinds.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/occlusion_settings.h"
#include "host/render/settings/settings_table.h"

namespace wavepath {
namespace {

constexpr std::array kKinds = {&kOcclusionSsao, &kOcclusionHbao, &kOcclusionGtao};
static_assert(kKinds.size() + 1 == kOcclusionNames.size());
constexpr std::array<std::string_view, 2> kRare = {"ao-bias", "ao-thinness"}; // settings that not all take

} // namespace

std::span<const OcclusionKind* const> occlusion_kinds() { return kKinds; }

const OcclusionKind* occlusion_kind(const RenderPlan& settings) {
  const std::string_view name = kOcclusionNames[settings.occlusion];
  const auto found = std::ranges::find_if(kKinds, [&](const OcclusionKind* kind) { return kind->name == name; });
  return found == kKinds.end() ? nullptr : *found;
}

bool takes_occlusion_setting(const RenderPlan& settings, std::string_view setting) {
  if (std::ranges::count(kRare, setting) == 0) return true;
  const OcclusionKind* kind = occlusion_kind(settings);
  return kind && std::ranges::count(kind->settings, setting) > 0;
}

void check_occlusion_settings(const RenderPlan& settings) {
  const std::string flag = fmt::format("--occlusion {}", kOcclusionNames[settings.occlusion]);
  for (const std::string_view name : kRare)
    if (!is_default(setting_named(name), settings) && !takes_occlusion_setting(settings, name))
      throw UsageError(fmt::format("--{}", name), fmt::format("is not taken by {}", flag), "leave it out");
  if (settings.occlusion == kOcclusionTraced) return;
  if (settings.ao_radius && *settings.ao_radius == 0.0)
    throw UsageError("--ao-radius 0", fmt::format("is unlimited, and {} looks no farther than a radius", flag),
                     "give one in metres, or leave it out");
  if (settings.integrator->finds_light && settings.max_depth <= 1)
    throw UsageError(flag, fmt::format("dims the ambient term, which --max-depth {} leaves out", settings.max_depth),
                     "leave one of them out");
}

} // namespace wavepath
