#include "host/session/viewing/render_line.h"

#include <fmt/format.h>

#include "host/base/shell_quote.h"
#include "host/picture/files/picture_io.h"
#include "host/render/settings/probing.h"
#include "host/render/settings/settings_table.h"
#include "host/scene/staging/view_flags.h"

namespace wavepath {
namespace {

// What the render of a mix is called, whose groups are apart.
constexpr const char* kGroupsFile = "light_groups.exr";

std::string tone_flags(const DisplayOptions& display) {
  std::string flags;
  if (!display.auto_exposure) flags += fmt::format(" --exposure {}", display.exposure);
  if (display.tonemap != WriteOptions{}.tonemap)
    flags += fmt::format(" --tonemap {}", kTonemapNames[static_cast<std::size_t>(display.tonemap)]);
  return flags;
}

} // namespace

std::string render_line(const std::string& scene, const ViewRequest& camera, const RenderPlan& settings,
                        const DisplayOptions& display, const std::string& more) {
  std::string line =
      fmt::format("wavepath render {}{}{}", shell_quoted(scene), camera_flags(camera), flags_of(settings));
  // The channel of the variance splits the samples of every pixel, so that bits differ. No other channel does; but
  // --aov-through is refused without channels.
  RenderPlan without = settings;
  without.aovs.clear();
  if (has_error_probes(without) != has_error_probes(settings) || settings.aov_through)
    line += fmt::format(" {}", flag_text(setting_named("aov"), settings));
  if (!display.mixes()) return line + tone_flags(display) + more;
  line += fmt::format("{} -o {} && wavepath relight {}", more, kGroupsFile, kGroupsFile);
  for (const GroupGain& gain : gains_of(settings, display))
    if (gain.factor.r != 1.0)
      line += fmt::format(" --gain {}", shell_quoted(fmt::format("{}={}", gain.group, gain.factor.r)));
  return line + tone_flags(display);
}

std::vector<GroupGain> gains_of(const RenderPlan& settings, const DisplayOptions& display) {
  std::vector<GroupGain> gains;
  for (std::size_t g = 0; g < settings.group_names.size(); ++g)
    gains.push_back({settings.group_names[g], glm::dvec3(std::stod(fmt::format("{}", display.group_gains[g])))});
  return gains;
}

} // namespace wavepath
