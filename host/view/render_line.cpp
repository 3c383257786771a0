#include "host/view/render_line.h"

#include <fmt/format.h>

#include "host/base/shell_quote.h"
#include "host/picture/files/picture_io.h"
#include "host/render/settings/probing.h"
#include "host/render/settings/settings_table.h"
#include "host/scene/staging/view_flags.h"

namespace wavepath {

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
  if (!display.auto_exposure) line += fmt::format(" --exposure {}", display.exposure);
  if (display.tonemap != WriteOptions{}.tonemap)
    line += fmt::format(" --tonemap {}", kTonemapNames[static_cast<std::size_t>(display.tonemap)]);
  return line + more;
}

} // namespace wavepath
