// wavepath render: checks, loads, packs, renders, writes, reports.
#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
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
#include "host/gpu/pipeline_cache.h"
#include "host/render/bvh_choice.h"
#include "host/render/depth_cut.h"
#include "host/render/diagnosis.h"
#include "host/render/identity.h"
#include "host/render/integrator.h"
#include "host/scene/scene_hash.h"

namespace wavepath {
namespace {

class Stopwatch {
public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

struct Request {
  SceneRequest scene;
  RenderRequest render;
  OutputRequest output;
  std::string command_line;
};

// Everything that can be known to fail is refused before the time of loading and rendering is spent.
void check_files(Request& request) {
  OutputRequest& output = request.output;
  if (output.pictures.empty()) output.pictures = {std::filesystem::path(request.scene.path).stem().string() + ".exr"};
  for (const std::string& path : output.pictures)
    if (!picture_format(path))
      throw UsageError(path, "has no extension that names a picture format", "end it in .exr, .hdr, .png or .jpg");
  require_file(request.scene.path);

  std::vector<std::string> targets = output.pictures;
  if (!output.stats.empty()) targets.push_back(output.stats);
  if (!request.render.state.file.empty()) targets.push_back(request.render.state.file);
  check_state_file(request.render.state);
  for (const std::string& target : targets) {
    require_writable(target);
    if (std::count(targets.begin(), targets.end(), target) > 1)
      throw UsageError(target, "is written twice", "give every output a name of its own");
    for (const std::string& input : {request.scene.path, output.reference, request.scene.environment}) {
      std::error_code error;
      if (std::filesystem::equivalent(target, input, error))
        throw UsageError(target, "would overwrite an input", "write somewhere else");
    }
  }
}

// The reference, read early so that a wrong one is refused early. A box-filtered one asks for the same filter.
std::optional<Picture> read_reference(Request& request) {
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
  settings.filter = request.render.filter.value_or(box ? gpu::kFilterBox : gpu::kFilterBlackmanHarris);
  return reference;
}

// `mergeable`: the identity that parts share, or empty.
PictureInfo picture_info(const Request& request, const View& view, const PackedScene& packed,
                         const RenderResult& result, const DeviceInfo& device, const std::string& mergeable,
                         const std::vector<std::string>& bias) {
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
    info.origin = packed.origin;
    info.film = result.film;
  }
  return info;
}

RenderResult render_shown(const Request& request, Device& device, const PackedScene& packed, const View& view,
                          KernelCompiler& kernels, RenderHooks hooks) {
  const RenderSettings& settings = request.render.settings;
  ProgressDisplay display(request.output.quiet, settings.time_limit, settings.target_error);
  catch_interrupts();
  hooks.progress = [&](const Progress& progress) {
    display.show(progress);
    return !interrupted();
  };
  return render(device, packed, view, settings, hooks, kernels);
}

// Tries every output even if one fails, because rendering was the expensive part; returns the first failure.
std::exception_ptr write_pictures(const Request& request, const PictureInfo& info, const Picture& picture,
                                  Warnings& warnings) {
  std::exception_ptr failure;
  for (const std::string& path : request.output.pictures) try {
      const std::uint64_t clamped = write_picture(path, picture, info, request.output.write);
      if (clamped > 0) warnings.add(path + ": value clamped to what the format holds", clamped);
    } catch (const Error&) {
      if (!failure) failure = std::current_exception();
    }
  return failure;
}

int exit_code(const Request& request, const RenderResult& result) {
  if (result.stop == StopReason::interrupted) return kExitInterrupted;
  const double target = request.render.settings.target_error;
  const std::optional<double> error = estimated_error(result);
  return target > 0.0 && !(error && *error <= target) ? kExitTargetMissed : kExitDone;
}

// A resumed render measures only the checkpoints that it passes itself; those before have no true error.
std::vector<TrueError> align(std::vector<TrueError> errors, std::size_t checkpoints) {
  if (errors.empty()) return errors;
  TrueError unknown;
  unknown.metrics.nonfinite_image = 1; // as of a picture that has no score
  errors.insert(errors.begin(), checkpoints - std::min(errors.size(), checkpoints), unknown);
  return errors;
}

// Prints the trace of one path. Writes no file.
int replay(const Request& request, Device& device, const PackedScene& packed, const View& view,
           KernelCompiler& kernels, const Warnings& warnings) {
  const RenderSettings& settings = request.render.settings;
  const PathTrace trace =
      PathReplay(device, packed, view, settings, kernels).trace(*request.render.pixel, *request.render.sample);
  device.pipeline_cache().save();
  print_warnings(warnings);
  const nlohmann::ordered_json document = trace_document(trace, packed, settings);
  fmt::print("{}", request.output.json ? to_text(document) : trace_text(document));
  return kExitDone;
}

int run_render(Request& request) {
  RenderSettings& settings = request.render.settings;
  settle_samples(request.render);
  check_integrator(request.render);
  check_replay(request.render);
  if (request.render.pixel)
    require_file(request.scene.path);
  else
    check_files(request);
  const std::optional<Picture> reference = read_reference(request);

  const Stopwatch loading;
  OpenScene open = open_scene(request.scene, request.render);
  Device& device = *open.device;
  KernelCompiler& kernels = *open.kernels;
  Scene& scene = open.scene;
  const View view = resolve_view(scene, request.scene.view, settings.width, settings.height);
  const bvh::Quality quality =
      request.render.bvh.value_or(choose_quality(settings, plan(scene).triangles_stored, device.info()));
  require_memory_for(request.scene.path, settings, plan(scene, quality), device.info());
  const bool identified = request.render.mergeable || !request.render.state.file.empty();
  std::string identity = identified ? identity_of(hash_scene(scene), view, settings) : std::string();
  if (const auto& origin = request.render.origin; identified && origin)
    identity += fmt::format(";origin={:a},{:a},{:a}", origin->x, origin->y, origin->z);
  const PackedScene packed = pack(scene, settings.direct, quality, request.render.origin.value_or(view.position));
  const double load_seconds = loading.seconds() - packed.bvh_seconds;
  Warnings warnings = scene.warnings;
  scene = Scene{}; // the device's copy is all that rendering needs

  if (request.render.pixel) return replay(request, device, packed, view, kernels, warnings);
  const StateRequest& state = request.render.state;
  const std::optional<RenderState> resumed = read_resumed(state, settings, identity, device.info(), warnings);
  std::vector<TrueError> true_errors;
  RenderHooks hooks{.save = state_saver(state, identity, device.info(), warnings), .save_interval = state.interval};
  if (resumed) hooks.resume = &*resumed;
  if (reference)
    hooks.checkpoint = [&](const Checkpoint&, const Picture& picture) {
      true_errors.push_back(measure_true_error(picture, *reference));
    };
  const RenderResult result = render_shown(request, device, packed, view, kernels, hooks);
  std::optional<DepthCut> cut; // of paths; frames of other integrators say nothing about it
  const bool reported = !request.output.stats.empty() || request.output.json || request.output.verbose;
  if (reported && settings.integrator->traces_paths && result.stop != StopReason::interrupted)
    cut = measure_depth_cut(device, packed, view, settings, kernels);
  Run run{request.scene.path, request.command_line, device.info(), settings, packed, result};
  run.bias = list_bias(settings, result, cut);
  run.true_errors = align(std::move(true_errors), result.checkpoints.size());
  run.diagnosis = diagnose(result, run.true_errors, run.bias);
  if (request.render.mergeable && !result.even)
    warnings.add("stopped before all pixels had the same samples, so the picture cannot be merged");

  const Stopwatch writing;
  const std::exception_ptr failure = write_pictures(
      request,
      picture_info(request, view, packed, result, device.info(), request.render.mergeable ? identity : "", run.bias),
      result.picture, warnings);
  run.write_seconds = writing.seconds();
  run.load_seconds = load_seconds;
  run.peak_bytes = device.memory_peak();
  run.total_seconds = seconds_since_process_start();
  device.pipeline_cache().save();
  run.kernel_cache = device.pipeline_cache().describe();
  report(run, request.output, warnings);
  if (failure) std::rethrow_exception(failure);
  if (request.render.strict && result.nonfinite.first)
    throw Error(request.scene.path,
                fmt::format("samples that were not finite: {}, {}", result.nonfinite.samples(),
                            describe_first(result.nonfinite, settings)),
                "report this with the scene, or render without --strict");
  return exit_code(request, result);
}

} // namespace

Command add_render(CLI::App& app, const std::string& command_line) {
  CLI::App* command = add_command(app, "render", "path-trace a glTF scene to a picture");
  const auto request = std::make_shared<Request>();
  request->command_line = command_line;
  add_output_flags(*command, request->output);
  add_picture_flags(*command, request->render);
  add_scene_flags(*command, request->scene, true);
  add_view_flags(*command, request->scene.view);
  add_stop_flags(*command, request->render);
  add_render_flags(*command, request->render);
  add_hybrid_flags(*command, request->render);
  add_replay_flags(*command, request->render);
  return [request] { return run_render(*request); };
}

} // namespace wavepath
