// wavepath view: a window that shows a render while it converges.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/base/output_files.h"
#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/cli/render_flags.h"
#include "host/cli/viewing.h"
#include "host/picture/picture_format.h"
#include "host/render/progressive/display.h"
#include "host/render/settings/settings_table.h"
#include "host/session/requests.h"
#include "host/view/comparison_choice.h"
#ifdef WAVEPATH_VIEWER
#include "host/view/window.h"
#endif

namespace wavepath {
namespace {

struct ViewCommandRequest {
  ViewingRequest viewing;
  ComparisonChoice comparison;
  std::uint32_t frames = 0; // 0 = until the window is closed
  std::string screenshot;
};

void check_comparison(ViewCommandRequest& request) {
  const bool judges = request.viewing.shown == Shown::shadow_error;
  if (!request.comparison.split && !judges) return;
  RenderPlan& settings = request.viewing.render.settings;
  if (!supports(*settings.integrator, "shadows"))
    throw UsageError(judges ? "--show shadow-error" : "--split",
                     fmt::format("compares shadow techniques, and --integrator {} has none", settings.integrator->name),
                     "add --integrator hybrid");
  if (std::ranges::count(settings.aovs, "direct") == 0) settings.aovs.emplace_back("direct");
}

void check(ViewCommandRequest& request) {
  ViewingRequest& viewing = request.viewing;
  const RenderPlan& settings = viewing.render.settings;
  check_comparison(request);
  check_viewing(viewing, request.frames);
  const std::string& screenshot = request.screenshot;
  if (screenshot.empty()) return;
  if (request.frames == 0)
    throw UsageError("--screenshot", "does not say when", "add --frames N, the samples per pixel to wait for");
  require_format(screenshot, settings.width, settings.height);
  refuse_overwriting({&screenshot, 1}, inputs_of(viewing.scene, settings));
  require_writable(screenshot);
}

#ifdef WAVEPATH_VIEWER

int show(const ViewCommandRequest& request) {
  const ViewingRequest& asked = request.viewing;
  const std::vector<const char*> extensions = window_extensions();
  Viewing viewing(asked, extensions, request.screenshot);
  WindowRequest window;
  window.title = std::filesystem::path(asked.scene.path).filename().string() + " - wavepath";
  window.framing = viewing.framing();
  window.more_flags = [&] { return viewing.flags(); };
  window.display = first_display(asked);
  window.comparison = request.comparison;
  window.target_error = asked.render.settings.target_error;
  window.frames = request.frames;
  window.screenshot = request.screenshot;
  window.notes = [&](const RenderPlan& settings) { return viewing.notes(settings); };
  window.save = [&](const std::string& path, const Picture& picture, const DisplayOptions& display) {
    viewing.save(path, picture, display);
  };
  const int code = run_window(viewing.scene(), window);
  viewing.save_kernels();
  return code;
}

int run_view(ViewCommandRequest& request) {
  check(request);
  return show(request);
}

#else

int run_view(ViewCommandRequest& request) {
  check(request);
  throw Error("view", "this build has no window", "build with -DWAVEPATH_VIEWER=ON, or use 'wavepath render'");
}

#endif

void add_window_flags(CLI::App& app, ViewCommandRequest& request) {
  const char* group = "Window";
  static constexpr HelpOverride kHelpOverrides[] = {
      {"spp", "samples per pixel at which rendering ends", "65536", kMostViewedSamples},
      {"target-error",
       "estimated relative RMS error to reach; 0.01 is 1 %. The window shows the remaining time, and stops rendering "
       "there unless --frames is given"}};
  add_settings(app, kByView, SettingGroup::stop, request.viewing.render, kHelpOverrides, group);
  add_show_flag(
      app, group,
      "first display: color, albedo, normal, depth, position, direct, indirect, emission, samples, variance, "
      "error, ao (hybrid only), roughness, metallic, triangles, instances, materials, or shadow-error (hybrid "
      "only: falsely lit in orange, falsely dark in blue)",
      request.viewing);
  add_flag(
      app, group,
      {"--split", "X",
       "position of a line, 0 to 1 of the width. The shadows of --against are shown right of it. Only with "
       "--integrator hybrid",
       "none"},
      [&](const FlagValue& value) { request.comparison.split = true, request.comparison.at = value.number(0.0, 1.0); });
  add_flag(
      app, group,
      {"--against", "NAME", "shadow technique for the comparison by --split and --show shadow-error", "traced"},
      [&](const FlagValue& value) { request.comparison.against = value.choice(choices_of(setting_named("shadows"))); });
  add_flag(app, group, {"--frames", "N", "samples per pixel at which the window closes", "none: it stays open"},
           [&](const FlagValue& value) {
             if (value.text.find(':') != std::string::npos)
               throw UsageError("--frames", "counts samples in a window, which shows one moment of an animation",
                                "give --at SECONDS, or render the film by wavepath render");
             request.frames = value.whole_number(1, kMostViewedSamples);
           });
  add_flag(app, group,
           {"--screenshot", "FILE",
            "picture to write at the end of --frames. .exr and .hdr are linear, .png and .jpg are tonemapped", "none"},
           [&](const FlagValue& value) { request.screenshot = value.text; });
}

} // namespace

Command add_view(CLI::App& app, const std::string& command_line) {
  CLI::App* command = add_command(app, "view", "render a scene in a window");
  const auto request = std::make_shared<ViewCommandRequest>();
  request->viewing.command_line = command_line;
  add_window_flags(*command, *request);
  add_viewing_flags(*command, "Window", request->viewing);
  return [request] { return run_view(*request); };
}

} // namespace wavepath
