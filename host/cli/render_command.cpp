// wavepath render: checks, loads, packs, renders, writes, reports.
#include <chrono>
#include <exception>
#include <filesystem>
#include <future>
#include <memory>

#include <fmt/format.h>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/base/memory.h"
#include "host/base/process_clock.h"
#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/cli/interrupt.h"
#include "host/cli/progress.h"
#include "host/cli/render_flags.h"
#include "host/cli/report.h"
#include "host/cli/scene_flags.h"
#include "host/gpu/pipeline_cache.h"
#include "host/render/bvh_choice.h"
#include "host/render/kernel_compiler.h"
#include "host/scene/features.h"

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

void require_file(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw Error(path, "does not exist", "check the name");
  if (std::filesystem::is_directory(path, error)) throw Error(path, "is a folder", "name a file");
}

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
  for (const std::string& target : targets) {
    require_writable(target);
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

// Host memory: the packed scene, the film as read back and the picture; with a CPU device, its buffers as well.
void require_memory_for(const Request& request, const Plan& plan, const DeviceInfo& device) {
  const RenderSettings& settings = request.render.settings;
  const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
  const std::uint64_t film =
      pixels * (gpu::kReplicates * sizeof(gpu::FilmPixel) + (settings.aovs.empty() ? 0 : sizeof(gpu::FilmAovs)));
  const std::uint64_t picture = pixels * sizeof(float) * (4 + 3 * settings.aovs.size());
  const std::uint64_t copies = device.type == "cpu" ? 2 : 1;
  require_memory(request.scene.path, fmt::format("rendering it at {}x{}", settings.width, settings.height),
                 copies * (plan.total() + film) + picture, "use a smaller --size, fewer --aov or a simpler scene");
}

PictureInfo picture_info(const Request& request, const View& view, const RenderResult& result,
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
  return info;
}

RenderResult render_shown(const Request& request, Device& device, const PackedScene& packed, const View& view,
                          KernelCompiler& kernels) {
  const RenderSettings& settings = request.render.settings;
  ProgressDisplay display(request.output.quiet, settings.time_limit, settings.target_error);
  catch_interrupts();
  const auto on_progress = [&](const Progress& progress) {
    display.show(progress);
    return !interrupted();
  };
  return render(device, packed, view, settings, on_progress, kernels);
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

// Compiles what the scene will most likely need. A wrong guess costs time alone.
void begin_kernels(KernelCompiler& kernels, const DeviceInfo& device, const Scene& scene,
                   const RenderSettings& settings) {
  std::uint32_t features = expected_features(scene, settings.direct);
  if (!settings.aovs.empty()) features |= gpu::kFeatureAovs;
  for (const Camera& camera : scene.cameras)
    if (camera.orthographic) features |= gpu::kFeatureOrthographic;
  kernels.start(kernel_config(features, kExpectedStack, settings));
  if (generic_first(device)) kernels.start(kernel_config(gpu::kFeaturesAll, kExpectedStack, settings));
}

int run_render(Request& request) {
  RenderSettings& settings = request.render.settings;
  settle_samples(request.render);
  check_files(request);
  const std::optional<Picture> reference = read_reference(request);

  // The device opens while the scene is read; kernels compile from the moment the scene's needs can be foreseen.
  const Stopwatch loading;
  auto opening = std::async(std::launch::async, [&] { return std::make_unique<Device>(request.render.device); });
  std::unique_ptr<Device> opened;
  std::optional<KernelCompiler> kernels;
  Scene scene = load_scene(request.scene, [&](const Scene& described) {
    opened = opening.get();
    begin_kernels(kernels.emplace(*opened), opened->info(), described, settings);
  });
  Device& device = *opened;
  const View view = resolve_view(scene, request.scene.view, settings.width, settings.height);
  const bvh::Quality quality =
      request.render.bvh.value_or(choose_quality(settings, plan(scene).triangles_stored, device.info()));
  require_memory_for(request, plan(scene, quality), device.info());
  const PackedScene packed = pack(scene, settings.direct, quality, view.position);
  const double load_seconds = loading.seconds() - packed.bvh_seconds;
  Warnings warnings = scene.warnings;
  scene = Scene{}; // the device's copy is all that rendering needs

  const RenderResult result = render_shown(request, device, packed, view, *kernels);
  Run run{request.scene.path, request.command_line, device.info(), settings, packed, result};
  run.bias = list_bias(settings);

  const Stopwatch writing;
  const std::exception_ptr failure =
      write_pictures(request, picture_info(request, view, result, run.bias), result.picture, warnings);
  run.write_seconds = writing.seconds();
  if (reference) run.true_error = measure_true_error(result.picture, *reference);
  run.load_seconds = load_seconds;
  run.peak_bytes = device.memory_peak();
  run.total_seconds = seconds_since_process_start();
  device.pipeline_cache().save();
  run.kernel_cache = device.pipeline_cache().describe();
  report(run, request.output, warnings);
  if (failure) std::rethrow_exception(failure);
  if (request.render.strict && result.nonfinite_samples > 0)
    throw Error(request.scene.path,
                fmt::format("{} samples were not finite, one in pixel {},{}", result.nonfinite_samples,
                            result.first_nonfinite[0], result.first_nonfinite[1]),
                "report this with the scene, or render without --strict");
  return exit_code(request, result);
}

} // namespace

Command add_render(CLI::App& app, const std::string& command_line) {
  CLI::App* command = app.add_subcommand("render", "path-trace a glTF scene to a picture");
  command->set_help_flag("-h,--help", "show this and exit")->group(kHelpGroup);
  const auto request = std::make_shared<Request>();
  request->command_line = command_line;
  add_output_flags(*command, request->output);
  add_picture_flags(*command, request->render);
  add_scene_flags(*command, request->scene, true);
  add_view_flags(*command, request->scene.view);
  add_stop_flags(*command, request->render);
  add_render_flags(*command, request->render);
  return [request] { return run_render(*request); };
}

} // namespace wavepath
