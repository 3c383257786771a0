// wavepath view: a window that shows a render while it converges.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/base/output_files.h"
#include "host/base/shell_quote.h"
#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/cli/render_flags.h"
#include "host/cli/scene_flags.h"
#include "host/gpu/pipeline_cache.h"
#include "host/picture/files/picture_io.h"
#include "host/plan/bvh_quality.h"
#include "host/plan/plan.h"
#include "host/render/progressive/display.h"
#include "host/render/progressive/progressive.h"
#include "host/render/settings/denoising.h"
#include "host/render/settings/pass_names.h"
#include "host/render/settings/settings_table.h"
#include "host/render/workspace/light_training.h"
#include "host/scene/pack/plan.h"
#include "host/session/judge.h"
#include "host/session/load.h"
#include "host/session/open_scene.h"
#include "host/session/resolve.h"
#include "host/session/session.h"
#include "host/view/comparison_choice.h"
#ifdef WAVEPATH_VIEWER
#include "host/view/window.h"
#endif

namespace wavepath {
namespace {

constexpr std::uint32_t kMostFrames = 1u << 30;
// Samples per pixel that the tree is to pay for: few, because the first picture should appear soon.
constexpr std::uint32_t kExpectedSamples = 16;

struct ViewCommandRequest {
  SceneRequest scene;
  RenderRequest render;
  WriteOptions tone;
  Shown shown = Shown::color;
  ComparisonChoice comparison;
  std::uint32_t frames = 0; // 0 = until the window is closed
  std::string screenshot;
  std::string command_line;
};

void check_comparison(ViewCommandRequest& request) {
  const bool judges = request.shown == Shown::shadow_error;
  if (!request.comparison.split && !judges) return;
  RenderPlan& settings = request.render.settings;
  if (!supports(*settings.integrator, "shadows"))
    throw UsageError(judges ? "--show shadow-error" : "--split",
                     fmt::format("compares shadow techniques, and --integrator {} has none", settings.integrator->name),
                     "add --integrator hybrid");
  if (std::ranges::count(settings.aovs, "direct") == 0) settings.aovs.emplace_back("direct");
}

void check(ViewCommandRequest& request) {
  RenderPlan& settings = request.render.settings;
  if (!can_show(*settings.integrator, request.shown))
    throw UsageError(fmt::format("--show {}", kShownNames[static_cast<std::size_t>(request.shown)]),
                     fmt::format("is not known to --integrator {}", settings.integrator->name),
                     "use --integrator hybrid or ao");
  if (!is_given(request.render, "spp")) settings.sample_total = request.frames ? request.frames : kOpenEndedSamples;
  settings.last_sample = settings.sample_total;
  if (request.frames > settings.last_sample)
    throw UsageError("--frames", fmt::format("{} is more than --spp {}", request.frames, settings.last_sample),
                     "give a number up to --spp");
  if (request.frames) settings.last_sample = request.frames;
  for (const std::string& aov : settings.aovs)
    if (is_pass(aov))
      throw UsageError(fmt::format("--aov {}", aov),
                       "is found once a picture is finished, and a window shows unfinished ones",
                       "use wavepath render");
  for (const std::string& aov : aovs_for(request.shown))
    if (std::ranges::count(settings.aovs, aov) == 0) settings.aovs.push_back(aov);
  check_comparison(request);
  check_integrator(request.render);
  if (denoises_film(settings))
    throw UsageError("--denoise", "filters finished pictures, and a window shows unfinished ones",
                     "use --integrator hybrid, or wavepath render");
  check_catcher(request.scene, request.render.settings);
  check_shutter(request.scene, request.render.settings);
  check_camera(request.scene.view, request.render.settings);
  require_file(request.scene.path);
  const std::string& screenshot = request.screenshot;
  if (screenshot.empty()) return;
  if (request.frames == 0)
    throw UsageError("--screenshot", "does not say when", "add --frames N, the samples per pixel to wait for");
  require_format(screenshot, settings.width, settings.height);
  refuse_overwriting({&screenshot, 1}, inputs_of(request.scene, settings));
  require_writable(screenshot);
}

#ifdef WAVEPATH_VIEWER

// The session in the window, and the render that it shows.
class Viewing {
public:
  explicit Viewing(const ViewCommandRequest& request)
      : request_(request), extensions_(window_extensions()), session_(request_of(request, extensions_)) {
    const Scene& scene = session_.scene();
    if (!request.screenshot.empty()) refuse_overwriting({&request.screenshot, 1}, scene.files);
    print_light(session_.loaded());
    RenderRequest first = request.render;
    first.settings.kernels.mips = true; // for frames in motion
    RenderPlan expected = first.settings;
    expected.last_sample = std::min(expected.last_sample, kExpectedSamples);
    if (!first.bvh) first.bvh = choose_quality(expected, plan(scene).triangles_stored, session_.device_info());
    session_.update(first);
    print_warnings(scene.warnings);
    const PackedScene& packed = session_.packed();
    // A copied command renders what the window shows: nothing is left for pilots to decide.
    RenderPlan shown = as_told(request.render.settings);
    shown.group_names = session_.prepared().group_names;
    // A window begins anew whenever the camera moves: no training unless asked for.
    if (shown.lights == gpu::kLightsAuto) shown.lights = usual_lights(packed);
    shown.moving = packed.moves();
    scene_.emplace(session_, shown);
  }

  int run() {
    const LoadedScene& loaded = session_.loaded();
    WindowRequest window;
    window.title = std::filesystem::path(request_.scene.path).filename().string() + " - wavepath";
    window.framing = loaded.framing.bounds.empty() ? find_framing(loaded.scene, false) : loaded.framing;
    window.more_flags = [this] { return flags(); };
    window.display = {.shown = request_.shown,
                      .exposure = request_.tone.exposure.value_or(0.0),
                      .auto_exposure = !request_.tone.exposure,
                      .tonemap = request_.tone.tonemap};
    window.comparison = request_.comparison;
    window.target_error = request_.render.settings.target_error;
    window.frames = request_.frames;
    window.screenshot = request_.screenshot;
    window.notes = [this](const RenderPlan& settings) { return list_bias(settings, session_.packed(), so_far()); };
    window.save = [this](const std::string& path, const Picture& picture, const DisplayOptions& display) {
      save(path, picture, display);
    };
    const int code = run_window(*scene_, window);
    session_.device().device->pipeline_cache().save();
    return code;
  }

private:
  static SessionRequest request_of(const ViewCommandRequest& request, std::span<const char* const> extensions) {
    SessionRequest wanted = session_request(request.scene, request.render);
    wanted.window_extensions = extensions;
    return wanted;
  }

  // What `wavepath render` needs besides camera and settings.
  std::string flags() const {
    const PackedScene& packed = session_.packed();
    std::string flags = flags_of(session_.scene_request());
    flags += fmt::format(" --origin {},{},{}", packed.origin.x, packed.origin.y, packed.origin.z);
    const RenderPlan& settings = render().settings();
    if (trains_light_selection(packed, settings)) flags += fmt::format(" --training-paths {}", settings.training.paths);
    if (!request_.render.device.empty()) flags += fmt::format(" --device {}", shell_quoted(request_.render.device));
    static const std::string kWritten[] = {"picture.exr"}; // the usual output of render
    return flags + layout_flags(request_.tone, kWritten);
  }

  // The parts of the result that list_bias() reads.
  RenderResult so_far() const {
    RenderResult result;
    result.nonfinite = render().nonfinite();
    result.ambient = render().status().ambient;
    return result;
  }

  void save(const std::string& path, const Picture& picture, const DisplayOptions& display) {
    const RenderPlan& settings = render().settings();
    const ProgressiveStatus status = render().status();
    PictureInfo info;
    info.spp = status.spp;
    info.seconds = status.seconds;
    if (status.error_spp > 0) info.error = status.error.relative_rms;
    info.seed = settings.seed;
    info.samples = fmt::format("{}:{}", settings.first_sample, settings.first_sample + status.spp);
    info.scene = request_.scene.path;
    info.command = request_.command_line;
    info.filter = kFilterNames[settings.filter];
    info.bias = fmt::format("{}", fmt::join(list_bias(settings, session_.packed(), so_far()), "; "));
    info.view = render().view();
    const std::optional<double> exposure = display.auto_exposure ? std::nullopt : std::optional(display.exposure);
    WriteOptions options = request_.tone;
    options.exposure = exposure;
    options.tonemap = display.tonemap;
    write_picture(path, picture, info, options);
  }

  const Progressive& render() const { return scene_->render(); }

  const ViewCommandRequest& request_;
  const std::vector<const char*> extensions_;
  Session session_;
  std::optional<ViewedScene> scene_;
};

int run_view(ViewCommandRequest& request) {
  check(request);
  return Viewing(request).run();
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
      {"spp", "samples per pixel at which rendering ends", "65536", kMostFrames},
      {"target-error",
       "estimated relative RMS error to reach; 0.01 is 1 %. The window shows the remaining time, and stops rendering "
       "there unless --frames is given"}};
  add_settings(app, kByView, SettingGroup::stop, request.render, kHelpOverrides, group);
  add_flag(app, group,
           {"--show", "WHAT",
            "first display: color, albedo, normal, depth, position, direct, indirect, emission, samples, variance, "
            "error, ao (hybrid only), roughness, metallic, triangles, instances, materials, or shadow-error (hybrid "
            "only: falsely lit in orange, falsely dark in blue)",
            "color"},
           [&](const FlagValue& value) { request.shown = static_cast<Shown>(value.choice(kShownNames)); });
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
             request.frames = value.whole_number(1, kMostFrames);
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
  request->command_line = command_line;
  add_window_flags(*command, *request);
  add_layout_flags(*command, "Window", request->tone, true);
  add_tone_flags(*command, request->tone);
  add_scene_flags(*command, request->scene, true);
  add_shutter_flag(*command, request->scene);
  add_view_flags(*command, request->scene.view);
  add_picture_flags(*command, kByView, request->render);
  add_transport_flags(*command, kByView, request->render);
  return [request] { return run_view(*request); };
}

} // namespace wavepath
