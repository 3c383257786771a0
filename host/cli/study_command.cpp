// wavepath study: checks, loads, renders the grid, writes the folder with its report.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <map>
#include <memory>

#include <unistd.h>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "host/base/atomic_file.h"
#include "host/base/clock.h"
#include "host/base/error.h"
#include "host/base/output_files.h"
#include "host/base/print.h"
#include "host/base/shell_quote.h"
#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/cli/interrupt.h"
#include "host/cli/render_flags.h"
#include "host/cli/scene_flags.h"
#include "host/integrators/hybrid/kind.h"
#include "host/integrators/hybrid/occlusion_radius.h"
#include "host/integrators/hybrid/shadows/sources.h"
#include "host/plan/bvh_quality.h"
#include "host/render/settings/settings_table.h"
#include "host/render/settings/textures.h"
#include "host/scene/pack/plan.h"
#include "host/study/page.h"
#include "host/study/study_report.h"

namespace wavepath {
namespace {

namespace fs = std::filesystem;

struct StudyCommandRequest {
  SceneRequest scene;
  RenderRequest render; // what all configurations have in common
  StudySettings study;
  std::string folder, reference, command_line;
  bool quiet = false, shadows = false;
};

// Light samples of a pixel's sample where shadows are compared: as many as there are lights, up to this number. What is
// seen of many lights with fewer is which of them was picked.
constexpr std::size_t kMostShadowSamples = 16;
constexpr std::uint32_t kSide = 256;             // small enough for a whole grid to be done in minutes without a GPU
constexpr std::uint32_t kHighestSeed = 1u << 29; // points add to it, and the reference sets bit 30

// An integrator that takes all that is varied: the default one if it does.
void read_dimensions(const FlagValue& value, StudySettings& study) {
  study.vary = value.list(dimensions());
  if (std::ranges::count(study.vary, "integrator") > 0) return;
  const auto supports_all = [&](const IntegratorKind* kind) {
    return std::ranges::all_of(study.vary,
                               [&](const std::string& name) { return is_supported(setting_named(name), *kind); });
  };
  const auto found = std::ranges::find_if(integrators(), supports_all);
  if (found == integrators().end())
    value.refuse("varies settings that no integrator supports together", "vary the integrator as well");
  study.render.integrator = *found;
}

// Every shadow technique in maps of every size, of direct light alone.
void prepare_shadow_study(StudySettings& study) {
  study.vary = {"shadows", "shadow-size"};
  study.render.integrator = &kHybrid;
  study.render.max_depth = 1;
}

// Those that the study may write, but for a reference that it is given.
std::vector<std::string> targets_of(const StudyCommandRequest& request) {
  std::vector<std::string> targets = study_files(request.folder, make_grid(request.study.vary, request.study.render));
  if (!request.reference.empty()) std::erase(targets, (fs::path(request.folder) / kReferenceFile).string());
  return targets;
}

// Refuses what cannot work before the time of rendering is spent. Creates nothing yet.
void check_files(const StudyCommandRequest& request) {
  std::error_code error;
  if (!fs::is_regular_file(request.scene.path, error)) throw Error(request.scene.path, "is no file", "check the name");
  const bool there = fs::is_directory(request.folder, error);
  if (!there && fs::exists(request.folder, error))
    throw Error(request.folder, "is no folder", "name a folder, or a path where one can be made");
  refuse_overwriting(targets_of(request), inputs_of(request.scene, request.study.render, request.reference));
  require_writable(there ? (fs::path(request.folder) / "study.json").string() : request.folder);
}

std::optional<StudyReference> read_reference(StudyCommandRequest& request) {
  RenderPlan& settings = request.study.render;
  const bool filter_given = is_given(request.render, "filter");
  if (!filter_given) settings.filter = gpu::kFilterBox;
  const std::string& path = request.reference;
  if (path.empty()) return std::nullopt;
  StudyReference reference;
  reference.picture = read_picture(path);
  reference.file = path;
  const Picture& picture = reference.picture;
  if (picture.width != settings.width || picture.height != settings.height)
    throw UsageError(
        path, fmt::format("is {}x{}, the study {}x{}", picture.width, picture.height, settings.width, settings.height),
        fmt::format("add --size {}x{}", picture.width, picture.height));
  if (!compare_pictures(picture, picture).finite())
    throw Error(path, "holds values that are not finite", "name a picture whose values are all finite");
  if (const std::string error = read_attribute(path, "wavepath.error"); !error.empty())
    reference.error = std::stod(error);
  const auto filter = std::ranges::find(kFilterNames, read_attribute(path, "wavepath.filter"));
  if (!filter_given && filter != std::end(kFilterNames))
    settings.filter = static_cast<std::uint32_t>(filter - std::begin(kFilterNames));
  return reference;
}

// The part that the commands repeating each row share: the scene and camera flags as they were given, then the settings
// that all have in common. Each command has a seed of its own.
std::string repeat_command(const CLI::App& app, const StudyCommandRequest& request, bvh::Quality quality) {
  const RenderPlan& settings = request.study.render;
  std::string line = "wavepath render " + shell_quoted(request.scene.path);
  for (const CLI::Option* option : app.get_options([](const CLI::Option* o) {
         return o->count() > 0 && (o->get_group() == "Scene" || o->get_group() == "Camera");
       }))
    if (option->get_positional() == false)
      line += fmt::format(" --{} {}", option->get_lnames().front(), shell_quoted(option->results().back()));
  if (!request.render.device.empty()) line += " --device " + shell_quoted(request.render.device);
  for (const Setting& row : settings_table()) {
    const bool varied = std::ranges::count(request.study.vary, row.name) > 0;
    if ((row.offered & kByStudy) && row.name != "seed" && !varied) line += " " + flag_text(row, settings);
  }
  return line + fmt::format(" --bvh {}", kQualityNames[static_cast<std::size_t>(quality)]);
}

// One line: redrawn on a terminal, elsewhere printed at most every 5 s.
class StudyDisplay {
public:
  StudyDisplay(bool quiet, double budget) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0), budget_(budget) {}
  ~StudyDisplay() {
    if (drawn_ && terminal_) write_err("\r\x1b[K");
  }
  StudyDisplay(StudyDisplay&&) = delete;

  void show(const StudyProgress& progress) {
    const Clock::time_point now = Clock::now();
    if (quiet_ || now - last_ < std::chrono::milliseconds(terminal_ ? 100 : 5000)) return;
    last_ = now;
    drawn_ = true;
    const std::string text = fmt::format("{:.0f} of {:.0f} s: {}", progress.seconds, budget_, progress.what);
    print_err("{}", terminal_ ? "\r\x1b[K" + text : "wavepath: " + text + "\n");
  }

private:
  bool quiet_, terminal_, drawn_ = false;
  double budget_;
  Clock::time_point last_ = Clock::now();
};

// Packs the scene for all that the grid wants packed otherwise, and tells each warning once.
StudyScene pack_scene(LoadedScene& loaded, const StudyCommandRequest& request, bvh::Quality quality,
                      const DeviceInfo& device) {
  StudyScene study;
  Scene& scene = loaded.scene;
  study.view =
      resolve_view(scene, loaded.framing, request.scene.view, request.study.render.width, request.study.render.height);
  Warnings all = scene.warnings;
  const auto pack_for = [&](const RenderPlan& settings) {
    const StudyScene::Key key = StudyScene::key_of(settings);
    if (study.packed.contains(key)) return;
    scene.warnings = {};
    study.packed.emplace(key, pack(scene, {.direct = key.first,
                                           .quality = quality,
                                           .eye = study.view.position,
                                           .near = {study.view.position},
                                           .samplers = sampler_limits(settings, device)}));
    for (const auto& [text, count] : scene.warnings.counts())
      if (!all.counts().contains(text)) all.add(text, count);
  };
  RenderPlan common = request.study.render;
  common.direct = gpu::kDirectMis;
  pack_for(common);
  for (const Configuration& one : make_grid(request.study.vary, request.study.render)) pack_for(one.settings);
  print_warnings(all);
  return study;
}

// What was left out, by reason.
void print_unsupported(const Study& study) {
  std::map<std::string, std::vector<std::string>> names;
  for (const Unsupported& one : study.unsupported) names[one.why].push_back(one.name);
  for (const auto& [why, of] : names) print_err("wavepath: left out {}: {}\n", fmt::join(of, ", "), why);
}

int run_study_command(const CLI::App& app, StudyCommandRequest& request) {
  StudySettings& settings = request.study;
  const IntegratorKind* kind = settings.render.integrator;
  settings.render = request.render.settings;
  settings.render.integrator = kind;
  if (std::ranges::count(settings.vary, "textures") > 0) settings.render.textures = kTexturesExact; // of the reference
  if (request.shadows) prepare_shadow_study(settings);
  request.scene.sun_if_unlit = request.shadows;
  check_files(request);
  std::optional<StudyReference> reference = read_reference(request);

  Device device(request.render.device);
  LoadedScene loaded = load_scene(request.scene);
  refuse_overwriting(targets_of(request), loaded.scene.files);
  if (!request.quiet) print_light(loaded);
  RenderPlan whole = settings.render;
  whole.last_sample = 1 << 16;
  whole.time_limit = settings.budget;
  const bvh::Quality quality = choose_quality(whole, plan(loaded.scene).triangles_stored, device.info());
  const StudyScene packed = pack_scene(loaded, request, quality, device.info());
  const PackedScene& common = packed.packed.at({gpu::kDirectMis, settings.render.textures});
  if (std::ranges::count(settings.vary, "shadows") > 0)
    settings.render.shadow_samples =
        static_cast<std::uint32_t>(std::clamp(count_lights(common), std::size_t{1}, kMostShadowSamples));
  std::string repeat = repeat_command(app, request, quality);
  if (loaded.sun && !request.scene.sun) repeat += fmt::format(" --sun {},{}", loaded.sun->x, loaded.sun->y);
  loaded = LoadedScene{};
  // All configurations use the default radius of hybrid, so that one reference of occlusion serves them all.
  RenderPlan hybrid = settings.render;
  hybrid.integrator = &kHybrid;
  settings.render.ao_radius = occlusion_radius(common, hybrid);

  catch_interrupts();
  const Study study = [&] {
    StudyDisplay display(request.quiet, settings.budget);
    return run_study(device, packed, settings, std::move(reference), [&](const StudyProgress& progress) {
      display.show(progress);
      return !interrupted();
    });
  }();
  if (study.series.empty())
    throw Error(request.scene.path, "no configuration could be measured: " + study.unsupported.front().why,
                "ask for smaller maps or other techniques, or choose another device");
  if (!request.quiet) print_unsupported(study);
  if (study.series.front().points.empty() && study.lost.empty()) return kExitInterrupted;
  const auto end_if_lost = [&] {
    if (!study.lost.empty())
      throw DeviceLost(device.info().name, fmt::format("was lost while rendering ({})", study.lost),
                       "what had been measured is written; run again, or choose another device with --device");
  };
  if (study.series.front().points.empty()) end_if_lost();
  const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  const StudyRecord record{request.scene.path,
                           request.command_line,
                           fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(now)),
                           repeat,
                           request.folder,
                           device.info(),
                           settings,
                           study};
  write_study(record);
  write_page(request.folder);
  if (!request.quiet) print_err("wavepath: {}/report.html\n", request.folder);
  end_if_lost();
  return study.interrupted ? kExitInterrupted : kExitDone;
}

} // namespace

Command add_study(CLI::App& app, const std::string& command_line) {
  CLI::App* command = add_command(app, "study", "measure error against time for a grid of settings");
  const auto request = std::make_shared<StudyCommandRequest>();
  request->command_line = command_line;
  StudySettings& study = request->study;
  study.vary = {"sampler", "direct"};
  request->render.settings.width = request->render.settings.height = kSide;
  const char* group = "Study";
  add_flag(*command, group,
           {"-o,--output", "DIR",
            "folder for study.json, study.csv, report.html and pictures. It is created if its parent exists"},
           [request](const FlagValue& value) { request->folder = value.text; })
      ->required();
  CLI::Option* vary = add_flag(
      *command, group,
      {"--vary", "LIST", fmt::format("settings to vary, separated by commas: {}", fmt::join(dimensions(), ", ")),
       "sampler,direct"},
      [&study](const FlagValue& value) { read_dimensions(value, study); });
  add_switch(*command, group,
             {"--shadows", "",
              "vary every shadow technique that suits the scene, with maps of five sizes: errors by kind, milliseconds "
              "to build and to look up. Short for --vary shadows,shadow-size --max-depth 1",
              "off"},
             request->shadows)
      ->excludes(vary);
  add_flag(*command, group,
           {"--budget", "SECONDS",
            "total rendering time in seconds. The reference takes half of it (a fifth if shadows vary). The "
            "configurations divide the rest equally",
            "60"},
           [&study](const FlagValue& value) { study.budget = value.positive_number(); });
  add_flag(*command, group,
           {"--reference", "FILE.exr", "converged picture of the same view. Without it, the study renders one", "none"},
           [request](const FlagValue& value) { request->reference = value.text; });
  add_flag(*command, group,
           {"--reference-spp", "N", "samples per pixel of the reference", "as many as its part of the budget allows"},
           [&study](const FlagValue& value) { study.reference_spp = value.whole_number(2, 1 << 24); });
  static constexpr HelpOverride kHelpOverrides[] = {
      {"size", nullptr, "256x256"},
      {"filter", nullptr, "box, or what the reference has"},
      {"max-depth", "longest path in bounces, also of the reference"},
      {"seed", "seed of the first sample count. The other counts and the reference have their own", nullptr,
       kHighestSeed}};
  for (const SettingGroup settings :
       {SettingGroup::picture, SettingGroup::lens, SettingGroup::transport, SettingGroup::speed})
    add_settings(*command, kByStudy, settings, request->render, kHelpOverrides, group);
  add_device_flag(*command, request->render, group);
  add_switch(*command, group, {"-q,--quiet", "", "print no progress and no summary", "off"}, request->quiet);
  add_scene_flags(*command, request->scene, true);
  add_view_flags(*command, request->scene.view);
  return [request, command] { return run_study_command(*command, *request); };
}

} // namespace wavepath
