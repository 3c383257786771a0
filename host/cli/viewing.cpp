#include "host/cli/viewing.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/output_files.h"
#include "host/base/shell_quote.h"
#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/cli/render_flags.h"
#include "host/cli/scene_flags.h"
#include "host/gpu/device_class.h"
#include "host/gpu/pipeline_cache.h"
#include "host/picture/files/picture_io.h"
#include "host/plan/bvh_quality.h"
#include "host/plan/plan.h"
#include "host/render/settings/denoising.h"
#include "host/render/settings/pass_names.h"
#include "host/render/settings/settings_table.h"
#include "host/render/workspace/light_training.h"
#include "host/scene/pack/plan.h"
#include "host/session/judge.h"
#include "host/session/load.h"
#include "host/session/resolve.h"

namespace wavepath {
namespace {

// Samples per pixel that the tree is to pay for: few, because the first picture should appear soon.
constexpr std::uint32_t kExpectedSamples = 16;

SessionRequest session_of(const ViewingRequest& request, std::span<const char* const> extensions) {
  SessionRequest wanted = session_request(request.scene, request.render);
  wanted.window_extensions = extensions;
  return wanted;
}

} // namespace

void check_viewing(ViewingRequest& request, std::uint32_t frames) {
  RenderPlan& settings = request.render.settings;
  if (!can_show(*settings.integrator, request.shown))
    throw UsageError(fmt::format("--show {}", kShownNames[static_cast<std::size_t>(request.shown)]),
                     fmt::format("is not known to --integrator {}", settings.integrator->name),
                     "use --integrator hybrid or ao");
  if (!is_given(request.render, "spp")) settings.sample_total = frames ? frames : kOpenEndedSamples;
  settings.last_sample = settings.sample_total;
  if (frames > settings.last_sample)
    throw UsageError("--frames", fmt::format("{} is more than --spp {}", frames, settings.last_sample),
                     "give a number up to --spp");
  if (frames) settings.last_sample = frames;
  for (const std::string& aov : settings.aovs)
    if (is_pass(aov))
      throw UsageError(fmt::format("--aov {}", aov),
                       "is found once a picture is finished, and a window shows unfinished ones",
                       "use wavepath render");
  for (const std::string& aov : aovs_for(request.shown))
    if (std::ranges::count(settings.aovs, aov) == 0) settings.aovs.push_back(aov);
  check_shutter(request.scene, request.render.settings); // which the integrator's own check asks about
  check_integrator(request.render);
  if (denoises_film(settings))
    throw UsageError("--denoise", "filters finished pictures, and a window shows unfinished ones",
                     "use --integrator hybrid, or wavepath render");
  check_catcher(request.scene, request.render.settings);
  check_camera(request.scene.view, request.render.settings);
  require_file(request.scene.path);
}

void add_show_flag(CLI::App& app, const char* group, const char* choices, ViewingRequest& request) {
  add_flag(app, group, {"--show", "WHAT", choices, "color"},
           [&](const FlagValue& value) { request.shown = static_cast<Shown>(value.choice(kShownNames)); });
}

void add_viewing_flags(CLI::App& app, const char* group, ViewingRequest& request) {
  add_layout_flags(app, group, request.tone, true);
  add_tone_flags(app, request.tone);
  add_scene_flags(app, request.scene, true);
  add_shutter_flag(app, request.scene);
  add_view_flags(app, request.scene.view);
  add_picture_flags(app, kByView, request.render);
  add_transport_flags(app, kByView, request.render);
}

DisplayOptions first_display(const ViewingRequest& request) {
  return {.shown = request.shown,
          .exposure = request.tone.exposure.value_or(0.0),
          .auto_exposure = !request.tone.exposure,
          .tonemap = request.tone.tonemap};
}

Viewing::Viewing(const ViewingRequest& request, std::span<const char* const> window_extensions,
                 const std::string& output)
    : request_(request), session_(session_of(request, window_extensions)) {
  const Scene& scene = session_.scene();
  if (!output.empty()) refuse_overwriting({&output, 1}, scene.files);
  print_light(session_.loaded());
  RenderRequest first = request.render;
  first.settings.kernels.mips = true; // for frames in motion
  RenderPlan expected = first.settings;
  expected.last_sample = std::min(expected.last_sample, kExpectedSamples);
  if (!first.bvh) first.bvh = choose_quality(expected, plan(scene).triangles_stored, session_.device_info());
  session_.update(first);
  print_warnings(scene.warnings);
  const PackedScene& packed = session_.packed();
  // A copied command renders what is shown: nothing is left for pilots to decide.
  RenderPlan shown = as_told(request.render.settings);
  shown.group_names = session_.prepared().group_names;
  // A render that is looked at begins anew whenever the camera moves: no training unless asked for.
  if (shown.lights == gpu::kLightsAuto) shown.lights = usual_lights(packed);
  shown.moving = packed.moves();
  scene_.emplace(session_, shown);
}

Framing Viewing::framing() {
  const LoadedScene& loaded = session_.loaded();
  return loaded.framing.bounds.empty() ? find_framing(loaded.scene, false) : loaded.framing;
}

std::string Viewing::flags() const {
  const PackedScene& packed = session_.packed();
  std::string flags = flags_of(session_.scene_request());
  flags += fmt::format(" --origin {},{},{}", packed.origin.x, packed.origin.y, packed.origin.z);
  const RenderPlan& settings = render().settings();
  if (trains_light_selection(packed, settings)) flags += fmt::format(" --training-paths {}", settings.training.paths);
  if (!request_.render.device.empty()) flags += fmt::format(" --device {}", shell_quoted(request_.render.device));
  static const std::string kRenderWrites[] = {"picture.exr"}; // the usual output of render
  return flags + layout_flags(request_.tone, kRenderWrites);
}

std::vector<std::string> Viewing::notes(const RenderPlan& settings) const {
  return list_bias(settings, session_.packed(), so_far());
}

std::vector<Decision> Viewing::decisions(const RenderPlan& settings) const {
  const PackedScene& packed = session_.packed();
  std::vector<Decision> list;
  if (!request_.render.bvh) list.push_back(decision_of(packed.bvh_quality));
  const PlanRequest request{.settings = settings, .policy = Policy::as_told};
  const Plan rest = decide(request, packed, class_of(session_.device_info()), nullptr);
  list.insert(list.end(), rest.decisions.begin(), rest.decisions.end());
  return list;
}

RenderResult Viewing::so_far() const {
  RenderResult result;
  result.nonfinite = render().nonfinite();
  result.ambient = render().status().ambient;
  return result;
}

void Viewing::save(const std::string& path, const Picture& picture, const DisplayOptions& display) const {
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

void Viewing::save_kernels() { session_.device().device->pipeline_cache().save(); }

} // namespace wavepath
