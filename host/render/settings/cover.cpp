#include "host/render/settings/cover.h"

#include <algorithm>

#include "kernels/film/cover_types.h"

namespace wavepath {

bool is_cover(std::string_view aov) { return std::ranges::count(kCoverAovs, aov) > 0; }

bool compares_light(const RenderPlan& settings) {
  return settings.catches || std::ranges::count(settings.aovs, "shadow") > 0;
}

std::uint32_t cover_bits(const RenderPlan& settings) {
  return (settings.transparent || settings.catches ? gpu::kCoverTransparent : 0) |
         (compares_light(settings) ? gpu::kCoverDirect : 0);
}

bool has_cover(const RenderPlan& settings) {
  return settings.transparent || settings.catches || std::ranges::any_of(settings.aovs, is_cover);
}

RenderPlan without_cover(RenderPlan settings) {
  settings.transparent = settings.catches = false;
  std::erase_if(settings.aovs, is_cover);
  return settings;
}

} // namespace wavepath
