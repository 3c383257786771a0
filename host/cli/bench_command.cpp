// wavepath bench: loads, packs, measures, reports, and compares with an earlier run.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/base/failure.h"
#include "host/base/output_files.h"
#include "host/base/print.h"
#include "host/base/read_file.h"
#include "host/bench/bench_report.h"
#include "host/bench/builtin_scene.h"
#include "host/bench/compiled.h"
#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/cli/render_flags.h"
#include "host/cli/scene_flags.h"
#include "host/gpu/device.h"
#include "host/render/report/stats.h"
#include "host/render/settings/textures.h"

namespace wavepath {
namespace {

using Json = nlohmann::ordered_json;

struct BenchCommandRequest {
  SceneRequest scene;
  RenderRequest render;
  bool quiet = false;
  std::uint32_t repetitions = 7;
  bool ablate = false, kernels = false, structures = false;
  std::string json, baseline;
  double threshold = 10.0; // percent
};

// Compile times are measured, so no kernel may come from a cache.
void turn_kernel_caches_off() {
  setenv("WAVEPATH_CACHE", "off", 1);
  setenv("MESA_SHADER_CACHE_DISABLE", "true", 1); // Mesa
  setenv("__GL_SHADER_DISK_CACHE", "0", 1);       // NVIDIA
}

// Read before the measurement, so that a wrong file is refused early.
std::optional<Json> read_baseline(const std::string& path) {
  if (path.empty()) return std::nullopt;
  const std::optional<std::uint64_t> size = regular_file_size(path);
  std::vector<std::uint8_t> bytes(size.value_or(0));
  if (!size || !read_file(path, 0, bytes)) throw Error(path, "cannot be read", "name a file that bench --json wrote");
  Json json = Json::parse(bytes, nullptr, false);
  if (json.is_discarded()) throw Error(path, "is no JSON", "name a file that bench --json wrote");
  return json;
}

// Large enough to keep the device busy, small enough to take no more than about a minute.
void choose_size(BenchCommandRequest& request, const DeviceInfo& device) {
  if (is_given(request.render, "size")) return;
  const bool cpu = device.type == "cpu";
  request.render.settings.width = cpu ? 480 : 1920;
  request.render.settings.height = cpu ? 270 : 1080;
}

void refuse_to_overwrite(const BenchCommandRequest& request) {
  if (request.json.empty()) return;
  refuse_overwriting({&request.json, 1}, inputs_of(request.scene, request.render.settings, request.baseline));
  require_writable(request.json);
}

LoadedScene load(const BenchCommandRequest& request) {
  LoadedScene loaded = request.scene.path.empty() ? LoadedScene{builtin_scene(), {}, {}} : load_scene(request.scene);
  if (!request.json.empty()) refuse_overwriting({&request.json, 1}, loaded.scene.files);
  if (!request.quiet) print_light(loaded);
  return loaded;
}

// What a compiler makes does not depend on the picture.
int run_compiler(const BenchCommandRequest& request) {
  turn_kernel_caches_off();
  if (!request.baseline.empty())
    throw UsageError("--kernels", "measures nothing that --baseline compares", "leave one of them out");
  if (request.structures)
    throw UsageError("--kernels", "traces no rays that --structures compares", "leave one of them out");
  refuse_to_overwrite(request);
  Device device(request.render.device, {}, DeviceUse::compile);
  const RenderPlan& settings = request.render.settings;
  LoadedScene loaded = load(request);
  const PackedScene packed =
      pack(loaded.scene, {.direct = settings.direct, .samplers = sampler_limits(settings, device.info())});
  print_warnings(loaded.scene.warnings);
  const std::vector<CompiledKernel> kernels =
      compile_kernels(device, packed, settings, request.ablate, [&](const std::string& what) {
        if (!request.quiet) print_err("wavepath: compiling: {}\n", what);
      });
  if (!request.json.empty()) write_file(request.json, to_text(compiled_document(device.info(), kernels)));
  print_out("{}", compiled_table(device.info(), kernels));
  return kExitDone;
}

int run_bench(BenchCommandRequest& request) {
  turn_kernel_caches_off();
  const std::optional<Json> before = read_baseline(request.baseline);
  refuse_to_overwrite(request);
  Device device(request.render.device);
  choose_size(request, device.info());

  BenchSettings settings{request.render.settings, request.repetitions, request.ablate, request.structures};
  LoadedScene loaded = load(request);
  Scene& scene = loaded.scene;
  const View view =
      resolve_view(scene, loaded.framing, request.scene.view, settings.render.width, settings.render.height);
  const bvh::Quality quality = request.render.bvh.value_or(bvh::Quality::best);
  const PackedScene packed = pack(scene, {.direct = settings.render.direct,
                                          .quality = quality,
                                          .eye = view.position,
                                          .near = {view.position},
                                          .samplers = sampler_limits(settings.render, device.info())});
  const std::string path = scene.path;
  print_warnings(scene.warnings);
  scene = Scene{};

  const BenchResult result = bench(device, packed, view, settings, [&](const std::string& what) {
    if (!request.quiet) print_err("wavepath: measuring: {}\n", what);
  });
  const BenchRun run{path, device.info(), packed, settings, result};
  const Json document = bench_document(run);
  Attempts attempts;
  if (!request.json.empty()) attempts.attempt([&] { write_file(request.json, to_text(document)); });
  attempts.attempt([&] { print_out("{}", bench_table(run)); });
  attempts.finish();
  if (!before) return kExitDone;

  const Change change = compare_with_baseline(document, *before, request.baseline);
  print_out("\nsince {}\n{}", request.baseline, change.text);
  if (change.worst_percent <= request.threshold) return kExitDone;
  print_out("slower by more than {} %\n", request.threshold);
  return kExitFailed;
}

} // namespace

Command add_bench(CLI::App& app) {
  CLI::App* command = add_command(app, "bench", "measure the speed of each kernel, in your scene or in a built-in one");
  const auto request = std::make_shared<BenchCommandRequest>();
  const char* group = "Measurement";
  add_flag(*command, group,
           {"--repetitions", "N", "repetitions of every measurement, in turns. Medians are reported", "7"},
           [=](const FlagValue& value) { request->repetitions = value.whole_number(1, 1000); });
  add_switch(*command, group, {"--ablate", "", "measure the cost of each feature that this scene does not use", "off"},
             request->ablate);
  add_switch(
      *command, group,
      {"--structures", "",
       "also trace the same rays in an 8-wide, a binary and a linear BVH, a kd-tree, an octree, a uniform grid and a "
       "ray classification, whose build takes minutes in large scenes; and shadow rays to one lamp in these and in a "
       "light buffer",
       "off"},
      request->structures);
  add_switch(*command, group,
             {"--kernels", "",
              "print statistics of the driver's compiler for every kernel (registers, spills, occupancy, code size) "
              "instead of measurements. Works without the GPU of the driver",
              "off"},
             request->kernels);
  add_flag(*command, group, {"--baseline", "FILE.json", "result of an earlier run (--json), for a comparison", "none"},
           [=](const FlagValue& value) { request->baseline = value.text; });
  add_flag(
      *command, group,
      {"--threshold", "PERCENT", "largest drop of a rate since --baseline. With a larger one the exit code is 1", "10"},
      [=](const FlagValue& value) { request->threshold = value.number(0.0, 1e6); });
  add_flag(*command, "Output", {"--json", "FILE", "JSON file of all numbers", "not written"},
           [=](const FlagValue& value) { request->json = value.text; });
  add_switch(*command, "Output", {"-q,--quiet", "", "print no progress", "off"}, request->quiet);
  static constexpr HelpOverride kHelpOverrides[] = {{"size", nullptr, "480x270 on a CPU device, else 1920x1080"}};
  add_scene_flags(*command, request->scene, false);
  add_view_flags(*command, request->scene.view);
  add_settings(*command, kByBench, SettingGroup::picture, request->render, kHelpOverrides);
  add_settings(*command, kByBench, SettingGroup::lens, request->render);
  add_transport_flags(*command, kByBench, request->render);
  return [request] { return request->kernels ? run_compiler(*request) : run_bench(*request); };
}

} // namespace wavepath
