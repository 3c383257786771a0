// wavepath render: checks the request, prepares the scene, renders, writes and reports.
#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <new>

#include <fmt/format.h>

#include "host/base/atomic_file.h"
#include "host/base/clock.h"
#include "host/base/error.h"
#include "host/base/failure.h"
#include "host/base/output_files.h"
#include "host/base/print.h"
#include "host/base/process_clock.h"
#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/cli/interrupt.h"
#include "host/cli/open_scene.h"
#include "host/cli/progress.h"
#include "host/cli/render_flags.h"
#include "host/cli/report.h"
#include "host/cli/resume.h"
#include "host/cli/scene_flags.h"
#include "host/cli/trace_report.h"
#include "host/codecs/picture_module.h"
#include "host/gpu/pipeline_cache.h"
#include "host/picture/tev.h"
#include "host/render/bvh_choice.h"
#include "host/render/denoised.h"
#include "host/render/depth_cut.h"
#include "host/render/integrator_choice.h"
#include "host/render/memory_plan.h"
#include "host/render/pilot_length.h"
#include "host/render/report/diagnosis.h"
#include "host/render/report/state_file.h"
#include "host/render/reuse_choice.h"
#include "host/render/settings/identity.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/light_samples.h"
#include "host/render/settings/mips.h"
#include "host/render/settings/path_reuse.h"
#include "host/render/settings/settings_table.h"
#include "host/render/settings/shadow_settings.h"
#include "host/render/settings/textures.h"
#include "host/render/sky_choice.h"
#include "host/scene/pack/features.h"
#include "host/scene/pack/plan.h"
#include "host/scene/scene_hash.h"

namespace wavepath {
namespace {

class Stopwatch {
public:
  double seconds() const { return seconds_since(start_); }

private:
  Clock::time_point start_ = Clock::now();
};

struct RenderCommandRequest {
  SceneRequest scene;
  RenderRequest render;
  OutputRequest output;
  std::string command_line;
};

// Every file that the command writes.
std::vector<std::string> targets_of(const RenderCommandRequest& request) {
  std::vector<std::string> targets = request.output.pictures;
  for (const std::string& file : {request.output.stats, request.render.state.file})
    if (!file.empty()) targets.push_back(file);
  return targets;
}

// Channels and sums that no output would hold.
void check_channels(const RenderCommandRequest& request) {
  const auto& pictures = request.output.pictures;
  if (std::ranges::count(pictures, PictureFormat::exr, picture_format) > 0) return;
  const bool shown = !request.output.tev.empty(); // tev has all channels
  if (!request.render.settings.aovs.empty() && !shown)
    throw UsageError("--aov", fmt::format("channels go into .exr files, and {} is none", fmt::join(pictures, ", ")),
                     "add -o FILE.exr, or leave out --aov");
  if (request.render.mergeable && !is_given(request.render, "samples"))
    throw UsageError("--mergeable", fmt::format("sums go into .exr files, and {} is none", fmt::join(pictures, ", ")),
                     "add -o FILE.exr, or leave out --mergeable");
}

// Refuses files that cannot be read or written.
void check_files(RenderCommandRequest& request) {
  OutputRequest& output = request.output;
  if (output.pictures.empty()) output.pictures = {std::filesystem::path(request.scene.path).stem().string() + ".exr"};
  const RenderSettings& settings = request.render.settings;
  for (const std::string& path : output.pictures) {
    require_format(path, settings.width, settings.height);
    if (picture_format(path) == PictureFormat::hdr) begin_loading_pictures(); // its writer, beside the scene
  }
  check_channels(request);
  require_file(request.scene.path);
  const std::vector<std::string> targets = targets_of(request);
  refuse_overwriting(targets, inputs_of(request.scene, settings, output.reference));
  check_state_file(request.render.state);
  for (const std::string& target : targets) require_writable(target);
}

// The reference, read early so that a wrong one is refused early. A box-filtered one asks for the same filter.
std::optional<Picture> read_reference(RenderCommandRequest& request) {
  RenderSettings& settings = request.render.settings;
  const std::string& path = request.output.reference;
  std::optional<Picture> reference;
  if (!path.empty()) {
    reference = read_picture(path);
    if (reference->width != settings.width || reference->height != settings.height)
      throw UsageError(path,
                       fmt::format("is {}x{}, the render {}x{}", reference->width, reference->height, settings.width,
                                   settings.height),
                       fmt::format("render with --size {}x{}", reference->width, reference->height));
  }
  const bool box = reference && read_attribute(path, "wavepath.filter") == kFilterNames[gpu::kFilterBox];
  if (box && !is_given(request.render, "filter")) settings.filter = gpu::kFilterBox;
  return reference;
}

// `mergeable`: the identity that parts share, or empty.
PictureInfo picture_info(const RenderCommandRequest& request, const View& view, const PackedScene& packed,
                         const RenderResult& result, const DeviceInfo& device, const std::string& mergeable,
                         const std::vector<std::string>& bias, const SharedResult* shared) {
  const RenderSettings& settings = request.render.settings;
  PictureInfo info;
  info.spp = result.spp;
  info.seconds = result.seconds;
  info.error = estimated_error(result);
  info.seed = settings.seed;
  info.samples = fmt::format("{}:{}", settings.first_sample, settings.first_sample + result.spp);
  info.scene = request.scene.path;
  info.command = request.command_line;
  info.filter = kFilterNames[settings.filter];
  info.bias = fmt::format("{}", fmt::join(bias, "; "));
  info.view = view;
  if (!mergeable.empty() && result.even) {
    info.identity = mergeable;
    info.device = device_text(device);
    if (shared && !shared->bits_agree) info.device = "several devices that round differently";
    info.origin = packed.origin;
    info.film = result.film;
  }
  return info;
}

// `begin`: of the hooks, with progress on the terminal and interrupts.
template <class Begin>
auto render_shown(const RenderCommandRequest& request, RenderHooks hooks, const Begin& begin) {
  const RenderSettings& settings = request.render.settings;
  ProgressDisplay display(request.output.quiet, settings.time_limit, settings.target_error);
  catch_interrupts();
  hooks.progress = [&](const Progress& progress) {
    display.show(progress);
    return !interrupted();
  };
  return begin(hooks);
}

int exit_code(const RenderCommandRequest& request, const RenderResult& result) {
  if (result.stop == StopReason::interrupted) return kExitInterrupted;
  const double target = request.render.settings.target_error;
  const std::optional<double> error = estimated_error(result);
  return target > 0.0 && !(error && *error <= target) ? kExitTargetMissed : kExitDone;
}

// Refuses what cannot work before the time of loading and rendering is spent. Returns the reference, if there is one.
std::optional<Picture> check(RenderCommandRequest& request) {
  settle_settings(request.scene, request.render);
  check_replay(request.render);
  settle_devices(request.render);
  if (request.render.pixel && !request.output.tev.empty())
    throw UsageError("--pixel", "renders no picture that --tev could show", "leave out one of them");
  if (request.render.pixel)
    require_file(request.scene.path);
  else
    check_files(request);
  return read_reference(request);
}

// One of --devices.
struct OtherDevice {
  std::unique_ptr<Device> device;
  std::unique_ptr<KernelCompiler> kernels;
};

// A scene that is ready to be rendered.
struct Prepared {
  std::unique_ptr<Device> device;
  std::unique_ptr<KernelCompiler> kernels;
  std::vector<OtherDevice> others;
  std::unique_ptr<TevViewer> viewer; // of --tev
  View view;
  std::optional<MemoryCheck> memory;
  PackedScene packed;
  SceneOnDevice on_device;      // on `device`
  std::uint64_t scene_hash = 0; // where the identity needs it
  std::string identity;         // empty where nothing needs it
  Warnings warnings;
  double load_seconds = 0.0; // without building the BVH
};

bool needs_identity(const RenderCommandRequest& request) {
  return request.render.mergeable || !request.render.state.file.empty();
}

Prepared prepare(const RenderCommandRequest& request) {
  const RenderSettings& settings = request.render.settings;
  const Stopwatch loading;
  Prepared prepared;
  if (!request.output.tev.empty()) prepared.viewer = std::make_unique<TevViewer>(request.output.tev);
  OpenScene open = open_scene(request.scene, request.render); // its scene is freed here: rendering needs the packed one
  prepared.device = std::move(open.device);
  prepared.kernels = std::move(open.kernels);
  for (const std::string& wanted : request.render.other_devices) {
    OtherDevice& other = prepared.others.emplace_back();
    other.device = std::make_unique<Device>(wanted);
    other.kernels = std::make_unique<KernelCompiler>(*other.device);
  }
  const DeviceInfo& device = prepared.device->info();
  Scene& scene = open.loaded.scene;
  if (!request.render.pixel) refuse_overwriting(targets_of(request), scene.files);
  if (!request.output.quiet) print_light(open.loaded);
  const View view = resolve_view(scene, open.loaded.framing, request.scene.view, settings.width, settings.height);
  const bvh::Quality quality =
      request.render.bvh.value_or(choose_quality(settings, plan(scene).triangles_stored, device));
  Packing packing{.direct = direct_of(settings),
                  .quality = quality,
                  .eye = request.render.origin.value_or(view.position),
                  .near = {view.position},
                  .lights = settings.lights,
                  .mips = wants_mips(settings),
                  .samplers = sampler_limits(settings, device)};
  for (const OtherDevice& other : prepared.others)
    packing.samplers = common_limits(packing.samplers, other.device->info());
  prepared.memory.emplace(request.scene.path, plan(scene, packing), expected_features(scene, packing.direct), device);
  prepared.memory->require(settings);
  if (needs_identity(request)) prepared.scene_hash = hash_scene(scene);
  prepared.view = view;
  prepared.packed = pack(scene, packing);
  prepared.warnings = scene.warnings;
  prepared.load_seconds = loading.seconds() - prepared.packed.bvh_seconds;
  return prepared;
}

std::string identity_as(const RenderCommandRequest& request, const Prepared& prepared, const RenderSettings& settings) {
  std::string identity = identity_of(prepared.scene_hash, prepared.view, settings);
  if (const std::optional<glm::dvec3>& origin = request.render.origin)
    identity += fmt::format(";origin={:a},{:a},{:a}", origin->x, origin->y, origin->z);
  return identity;
}

// What --integrator auto, --sky-samples auto and --reuse auto may come to.
std::vector<RenderSettings> candidates_of(const RenderSettings& settings, const PackedScene& scene) {
  std::vector<RenderSettings> ways = {settings}, all;
  if (settings.reuse == kReuseAuto && may_reuse_paths(settings)) {
    ways.push_back(settings);
    ways.back().reuse = kReuseOn;
  }
  const std::uint32_t most_sky_samples = settings.sky_samples == 0 ? gpu::kMostLightSamples : 0;
  for (RenderSettings& one : ways)
    for (std::uint32_t i = 0; i <= most_sky_samples; ++i) {
      if (most_sky_samples > 0) one.sky_samples = i;
      if (!settings.integrator->candidates) {
        all.push_back(one);
        continue;
      }
      const std::vector<RenderSettings> candidates = settings.integrator->candidates(one, scene);
      all.insert(all.end(), candidates.begin(), candidates.end());
    }
  return all;
}

// What they had come to when the file of --resume was begun, maybe for fewer samples. Empty if there is no such file,
// or it is of another render.
std::optional<RenderSettings> recorded_choice(const RenderCommandRequest& request, const Prepared& prepared) {
  const RenderSettings& settings = request.render.settings;
  std::error_code error;
  if (!request.render.state.resume || !std::filesystem::exists(request.render.state.file, error)) return std::nullopt;
  const bool chooses = settings.integrator->candidates || may_share_sky(settings, prepared.packed.features) ||
                       (settings.reuse == kReuseAuto && may_reuse_paths(settings));
  if (!chooses) return std::nullopt;
  const std::string recorded = read_state(request.render.state.file).identity;
  for (const RenderSettings& candidate : candidates_of(settings, prepared.packed))
    if (identity_as(request, prepared, candidate) == recorded) return candidate;
  return std::nullopt;
}

struct Choices {
  SkyChoice sky;
  ReuseChoice reuse;
  IntegratorChoice integrator;
};

// What pilots decide about the render, and who it then is.
Choices settle_choices(RenderCommandRequest& request, Prepared& prepared) {
  RenderSettings& settings = request.render.settings;
  if (stands_alone(request.render)) set_pilot_lengths(settings, prepared.device->info().type == "cpu");
  Choices choices;
  if (const std::optional<RenderSettings> recorded = recorded_choice(request, prepared)) {
    settings = *recorded;
    settings.tries_sky = false;
    settings.tries_reuse = kTriesReuseNowhere;
  } else {
    const auto tell = [&](bool wanted, const std::string& text) {
      if (wanted && !request.output.quiet) print_err("wavepath: {}\n", text);
    };
    choices.sky = choose_sky_samples(*prepared.device, prepared.packed, prepared.view, settings, *prepared.kernels,
                                     prepared.on_device);
    if (choices.sky.samples > 0) settings.sky_samples = choices.sky.samples;
    settings.tries_sky = choices.sky.keeps_kernels;
    tell(choices.sky.samples > 1, sky_choice_text(choices.sky));
    const bool stands_for_others = settings.integrator->candidates != nullptr;
    choices.integrator =
        choose_integrator(*prepared.device, prepared.packed, prepared.view, settings, *prepared.kernels,
                          prepared.on_device, [&](const RenderSettings& way) { return prepared.memory->fits(way); });
    settings = choices.integrator.settings;
    const bool chose = !choices.integrator.trials.empty() || !choices.integrator.too_large.empty();
    tell(stands_for_others && (chose || is_given(request.render, "integrator")), choice_text(choices.integrator));
    // Last: what tells whether other ways are worth trying is the error of paths that share nothing.
    choices.reuse =
        choose_reuse(*prepared.device, prepared.packed, prepared.view, settings, *prepared.kernels, prepared.on_device);
    if (choices.reuse.pays) settings.reuse = kReuseOn;
    settings.tries_reuse = choices.reuse.tries_reuse;
    tell(choices.reuse.pays, reuse_choice_text(choices.reuse));
  }
  prepared.memory->require(settings); // which a state may have told, or pilots made to take more
  if (needs_identity(request)) prepared.identity = identity_as(request, prepared, settings);
  return choices;
}

// What the pilot of a render learns of lights. One sample of the picture is rendered besides.
LightShares learn_light_shares(const RenderCommandRequest& request, Prepared& prepared) {
  const RenderSettings& settings = request.render.settings;
  const StateRequest& state = request.render.state;
  if (!LightTeacher::has_lesson(prepared.packed, settings)) return {};
  RenderSettings one = settings;
  std::error_code error;
  if (state.resume && std::filesystem::exists(state.file, error)) // a render that was resumed keeps its pilot
    one.light_pilot_paths = read_state(state.file).state.light_pilot_paths;
  one.sample_total = settings.sample_total > 0 ? settings.sample_total : settings.last_sample; // samplers may ask
  one.last_sample = one.first_sample + 1;
  one.adaptive = kAdaptiveOff;
  const auto rendered = render(*prepared.device, prepared.packed, prepared.view, one, RenderHooks{}, *prepared.kernels,
                               &prepared.on_device);
  return rendered.light_pilot.shares;
}

// Prints the trace of one path. Writes no file.
int replay(const RenderCommandRequest& request, Prepared& prepared) {
  RenderSettings settings = request.render.settings;
  Device& device = *prepared.device;
  settings.light_shares = learn_light_shares(request, prepared);
  PathReplay replay(device, prepared.packed, prepared.view, settings, *prepared.kernels);
  const PathTrace trace = replay.trace(*request.render.pixel, *request.render.sample, request.render.net);
  device.pipeline_cache().save();
  print_warnings(prepared.warnings);
  const nlohmann::ordered_json document = trace_document(trace, prepared.packed, settings);
  print_out("{}", request.output.json ? to_text(document) : trace_text(document));
  return kExitDone;
}

// The picture is there, or will be, whatever becomes of what a report tells besides: where that fails, why it did.
// `what` was not measured then, which a warning tells.
template <class Measure>
std::string why_not_measured(Prepared& prepared, const char* what, const Measure& measure) {
  std::string why;
  try {
    measure();
  } catch (const DeviceLost&) {
    why = "the device was lost after the last sample";
  } catch (const std::exception& failure) {
    why = failure_text(failure);
  }
  if (!why.empty()) prepared.warnings.add(fmt::format("{} not measured: {}", what, why));
  return why;
}

TrueError unknown_error() {
  TrueError unknown;
  unknown.metrics.nonfinite_image = 1; // as of a picture that has no score
  return unknown;
}

// Notes in `true_errors` one for each checkpoint that this run passes.
std::function<void(const Checkpoint&, const Picture&)> measure_checkpoints(Prepared& prepared, const Picture& reference,
                                                                           std::vector<TrueError>& true_errors) {
  return [&](const Checkpoint&, const Picture& picture) {
    TrueError error = unknown_error();
    why_not_measured(prepared, "the true error was", [&] { error = measure_true_error(picture, reference); });
    true_errors.push_back(error);
  };
}

// A resumed render measures only the checkpoints that it passes itself; those before have no true error.
std::vector<TrueError> align(std::vector<TrueError> errors, std::size_t checkpoints) {
  if (errors.empty()) return errors;
  errors.insert(errors.begin(), checkpoints - std::min(errors.size(), checkpoints), unknown_error());
  return errors;
}

// Shows the picture in the viewer of --tev. One that goes away does not end the render.
void show(const RenderCommandRequest& request, Prepared& prepared, const Picture& picture) {
  if (!prepared.viewer) return;
  try {
    if (prepared.viewer->show(request.output.pictures.front(), picture)) return;
  } catch (const std::bad_alloc&) { // no room for a copy
  }
  prepared.viewer.reset();
  prepared.warnings.add("--tev: the viewer is gone; the render went on without it");
}

// Renders on all of --devices.
SharedResult render_shared(const RenderCommandRequest& request, Prepared& prepared,
                           const std::optional<Picture>& reference, std::vector<TrueError>& true_errors) {
  std::vector<RenderingDevice> devices{{prepared.device.get(), prepared.kernels.get()}};
  for (const OtherDevice& other : prepared.others) devices.push_back({other.device.get(), other.kernels.get()});
  RenderHooks hooks;
  if (reference) hooks.checkpoint = measure_checkpoints(prepared, *reference, true_errors);
  if (prepared.viewer) hooks.show = [&](const Picture& picture) { show(request, prepared, picture); };
  SharedResult shared = render_shown(request, hooks, [&](const RenderHooks& shown) {
    return render_by_several(devices, prepared.packed, prepared.view, request.render.settings, shown);
  });
  if (!shared.bits_agree)
    prepared.warnings.add("the devices round differently, so that the last bits of the picture depend on their shares");
  for (const DeviceShare& share : shared.shares)
    if (share.lost) prepared.warnings.add(share.name + ": was lost while rendering; the others took over");
  return shared;
}

// Renders, from the state of --checkpoint on where --resume asks for it. `true_errors`: one for each checkpoint that
// this run passes, if there is a reference.
RenderResult render_prepared(const RenderCommandRequest& request, Prepared& prepared,
                             const std::optional<Picture>& reference, std::vector<TrueError>& true_errors) {
  const StateRequest& state = request.render.state;
  const DeviceInfo& device = prepared.device->info();
  RenderSettings settings = request.render.settings;
  const std::optional<RenderState> resumed =
      read_resumed(state, settings, prepared.identity, device, prepared.warnings);
  if (resumed && !resumed->levels.empty()) {
    if (request.render.mergeable)
      throw Error(state.file, "has given noisy pixels more samples, so that its picture cannot be merged",
                  "leave out --samples and --mergeable, or begin anew with them");
    settings.tries_adaptive = true; // as before, however long the rest is
  }
  if (resumed) {
    settings.light_pilot_paths = resumed->light_pilot_paths; // likewise
    settings.guide_iterations = resumed->guide_iterations;
    RenderSettings part = settings;
    part.light_pilot_paths = 0;
    const bool learned_lights = resumed->light_pilot_paths != 0 && LightTeacher::has_lesson(prepared.packed, part);
    const bool learned_longer = settings.guide && resumed->guide_iterations != kGuideIterations;
    if (request.render.mergeable && (learned_lights || learned_longer))
      throw Error(state.file, "has learned of light as parts do not, so that its picture cannot be merged",
                  "leave out --samples and --mergeable, or begin anew with them");
  }
  RenderHooks hooks{.save = state_saver(state, prepared.identity, device, prepared.warnings),
                    .save_interval = state.interval,
                    .salvages = true};
  if (resumed) hooks.resume = &*resumed;
  if (reference) hooks.checkpoint = measure_checkpoints(prepared, *reference, true_errors);
  if (prepared.viewer) hooks.show = [&](const Picture& picture) { show(request, prepared, picture); };
  RenderResult result = render_shown(request, hooks, [&](const RenderHooks& shown) {
    return render(*prepared.device, prepared.packed, prepared.view, settings, shown, *prepared.kernels,
                  &prepared.on_device);
  });
  result.upload_seconds = prepared.on_device.upload_seconds; // by a pilot, perhaps
  return result;
}

bool reports_bias(const RenderCommandRequest& request) {
  return !request.output.stats.empty() || request.output.json || request.output.verbose;
}

// Then there is no time, or no device, to find out more.
bool ended_early(const RenderResult& result) {
  return result.stop == StopReason::interrupted || result.stop == StopReason::device_lost;
}

// The first device that was not lost, for what is measured after the render.
RenderingDevice surviving(const Prepared& prepared, const SharedResult* shared) {
  for (std::size_t i = 1; shared && i < shared->shares.size() && shared->shares.front().lost; ++i)
    if (!shared->shares[i].lost) return {prepared.others[i - 1].device.get(), prepared.others[i - 1].kernels.get()};
  return {prepared.device.get(), prepared.kernels.get()};
}

// What light is missing, where a report tells it. An interrupt ends the measurement, not the command.
MissingLight missing_light(const RenderCommandRequest& request, Prepared& prepared, const RenderResult& result,
                           const SharedResult* shared) {
  MissingLight missing;
  if (!reports_bias(request) || ended_early(result)) return missing;
  const RenderSettings& settings = request.render.settings;
  const RenderingDevice on = surviving(prepared, shared);
  SceneOnDevice elsewhere;
  SceneOnDevice& on_device = on.device == prepared.device.get() ? prepared.on_device : elsewhere;
  const auto go_on = [](const Progress&) { return !interrupted(); };
  constexpr const char* kWhat = "how much light is missing was";
  if (settings.integrator->measures_depth_cut) // its paths are cut
    missing.no_cut = why_not_measured(prepared, kWhat, [&] {
      missing.cut =
          measure_depth_cut(*on.device, prepared.packed, prepared.view, settings, *on.kernels, on_device, go_on);
    });
  missing.no_lost = why_not_measured(prepared, kWhat, [&] {
    missing.lost =
        measure_lost_light(*on.device, prepared.packed, prepared.view, settings, *on.kernels, on_device, go_on);
  });
  return missing;
}

// Writes the pictures, reports what the run measured, and returns the exit code. Throws Error.
int finish(const RenderCommandRequest& request, Prepared& prepared, Run& run, Attempts& attempts) {
  const RenderSettings& settings = request.render.settings;
  const RenderResult& result = run.result;
  Device& device = *prepared.device;
  const Stopwatch writing;
  const std::string mergeable = request.render.mergeable ? prepared.identity : "";
  const PictureInfo info =
      picture_info(request, prepared.view, prepared.packed, result, device.info(), mergeable, run.bias, run.shared);
  OutputRequest output = request.output;
  write_pictures(output, info, result.picture, prepared.warnings, attempts);
  run.write_seconds = writing.seconds();
  run.load_seconds = prepared.load_seconds;
  run.peak_bytes = device.memory_peak();
  if (device.memory_displaced() > 0)
    prepared.warnings.add(fmt::format("the device's memory is full: {:.1f} MiB lie elsewhere, which is much slower",
                                      static_cast<double>(device.memory_displaced()) / 1048576.0));
  run.total_seconds = seconds_since_process_start();
  device.pipeline_cache().save();
  run.kernel_cache = device.pipeline_cache().describe();
  report(run, output, prepared.warnings, attempts);
  if (prepared.viewer && !prepared.viewer->finish()) // all else is done, so that it costs a second at most
    print_err("wavepath: warning: --tev: the viewer did not take the whole picture\n");
  attempts.finish();
  if (request.render.strict && result.nonfinite.first)
    throw Error(request.scene.path,
                fmt::format("samples that were not finite: {}, {}", result.nonfinite.samples(),
                            describe_first(result.nonfinite, settings)),
                "report this with the scene, or render without --strict");
  if (result.stop == StopReason::device_lost)
    throw DeviceLost(
        device.info().name,
        fmt::format("was lost while rendering; what is written has the first {} samples a pixel", result.spp),
        request.render.state.file.empty() ? "render with --checkpoint to go on after such an end"
        : request.render.state.resume     ? "run the same command to go on"
                                          : "add --resume to go on");
  return exit_code(request, result);
}

// Writers that had to be loaded are there: what cannot be written is not rendered.
void require_writers(const OutputRequest& output) {
  for (const std::string& path : output.pictures)
    if (picture_format(path) == PictureFormat::hdr) picture_module(path);
}

int run_render(RenderCommandRequest& request) {
  const std::optional<Picture> reference = check(request);
  Prepared prepared = prepare(request);
  require_writers(request.output);
  request.render.settings.moving = prepared.packed.moves(); // else the shutter would cost something
  const Choices choices = settle_choices(request, prepared);
  if (!choices.integrator.disagreement.empty()) prepared.warnings.add(choices.integrator.disagreement);
  if (const std::string unlit = unlit_bodies(prepared.packed); !unlit.empty()) prepared.warnings.add(unlit);
  if (request.render.pixel) return replay(request, prepared);

  const RenderSettings& settings = request.render.settings;
  std::vector<TrueError> true_errors;
  std::optional<SharedResult> shared;
  if (!prepared.others.empty()) {
    prepared.on_device = {}; // each device uploads it by itself
    shared = render_shared(request, prepared, reference, true_errors);
  }
  RenderResult result = shared ? std::move(shared->result) : render_prepared(request, prepared, reference, true_errors);
  Attempts attempts; // the picture as it was rendered is there, whatever becomes of its filtered one
  attempts.attempt([&] { denoise_if_asked(result, settings); });
  show(request, prepared, result.picture);
  Run run{request.scene.path, request.command_line, prepared.device->info(), settings, prepared.packed, result};
  if (!choices.integrator.trials.empty()) run.choice = &choices.integrator;
  if (choices.sky.samples > 0) run.sky_choice = &choices.sky;
  if (choices.reuse.tried) run.reuse_choice = &choices.reuse;
  if (shared) run.shared = &*shared;
  run.bias = list_bias(settings, prepared.packed, result, missing_light(request, prepared, result, run.shared));
  if (reference && result.denoised)
    why_not_measured(prepared, "the true error of the filtered picture was",
                     [&] { run.denoised_error = measure_true_error(shown_picture(result.picture), *reference); });
  run.true_errors = align(std::move(true_errors), result.checkpoints.size());
  run.diagnosis = diagnose(settings, prepared.packed, result, run.true_errors, run.bias);
  if (request.render.mergeable && !result.even)
    prepared.warnings.add("stopped before all pixels had the same samples, so the picture cannot be merged");
  return finish(request, prepared, run, attempts);
}

} // namespace

Command add_render(CLI::App& app, const std::string& command_line) {
  CLI::App* command = add_command(app, "render", "path-trace a glTF scene to a picture");
  const auto request = std::make_shared<RenderCommandRequest>();
  request->command_line = command_line;
  add_output_flags(*command, request->output);
  add_picture_flags(*command, kByRender, request->render);
  add_scene_flags(*command, request->scene, true);
  add_shutter_flag(*command, request->scene);
  add_view_flags(*command, request->scene.view);
  add_stop_flags(*command, request->render);
  add_transport_flags(*command, kByRender, request->render);
  add_devices_flag(*command, request->render);
  add_replay_flags(*command, request->render);
  return [request] { return run_render(*request); };
}

} // namespace wavepath
