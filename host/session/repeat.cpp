#include "host/session/repeat.h"

#include <fmt/format.h>

#include "host/base/shell_quote.h"
#include "host/render/settings/settings_table.h"
#include "host/render/workspace/light_training.h"
#include "host/scene/staging/view_flags.h"
#include "host/session/resolve.h"

namespace wavepath {

std::string repeat_command(const SceneRequest& scene, const RenderRequest& render, const MotionRequest& motion,
                           const Prepared& prepared, const RenderResult& result) {
  RenderPlan settings = prepared.plan.settings;
  const bool adapts = result.noise && result.noise->used;
  const bool by_clock = settings.time_limit > 0.0 || settings.target_error > 0.0;
  if (adapts ? by_clock || result.stop != StopReason::samples : !result.even) return "";
  const bool is_whole = adapts || result.spp == settings.last_sample - settings.first_sample;
  if (!is_whole && settings.sampler == gpu::kSamplerStratified) return ""; // whose points depend on the samples planned
  if (!is_whole && settings.sample_total == 0) settings.last_sample = settings.first_sample + result.spp;
  if (settings.adaptive == kAdaptiveAuto) settings.adaptive = adapts ? kAdaptiveOn : kAdaptiveOff;
  std::string command = fmt::format("wavepath render {}{}{}{} --origin {},{},{}", shell_quoted(scene.path),
                                    camera_flags(scene.view), flags_of(settings), flags_of(scene),
                                    prepared.packed.origin.x, prepared.packed.origin.y, prepared.packed.origin.z);
  // Channels, which flags_of() leaves out: that of the variance splits the samples of every pixel, so that bits differ.
  if (const std::string channels = flag_text(setting_named("aov"), settings); !channels.empty())
    command += " " + channels + flags_of(motion);
  if (stands_alone(render) && (settings.guide || trains_light_selection(prepared.packed, settings)))
    command += fmt::format(" --training-paths {}", settings.training.paths);
  if (stands_alone(render) && settings.guide)
    command += fmt::format(" --guide-iterations {}", settings.training.guide_iterations);
  if (!render.device.empty() && render.devices.empty())
    command += fmt::format(" --device {}", shell_quoted(render.device));
  if (!render.devices.empty()) command += fmt::format(" --devices {}", shell_quoted(render.devices));
  if (render.mergeable) command += " --mergeable";
  return command;
}

} // namespace wavepath
