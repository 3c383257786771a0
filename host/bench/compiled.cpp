#include "host/bench/compiled.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <span>

#include <fmt/format.h>

#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/settings_table.h"
#include "host/render/settings/traversal.h"
#include "host/render/workspace/kernel_compiler.h"

namespace wavepath {
namespace {

using Json = nlohmann::ordered_json;

// Parts of the names of statistics that decide how fast kernels run, as drivers of AMD, Intel and NVIDIA have them.
constexpr std::array<std::string_view, 12> kTold = {"subgroup size", "gpr",        "regist",    "spill",
                                                    "scratch",       "occupan",    "waves",     "local mem",
                                                    "latency",       "throughput", "code size", "cycle"};

bool is_told(std::string name) {
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::ranges::any_of(kTold, [&](std::string_view part) { return name.find(part) != std::string::npos; });
}

std::string number(double value) {
  return value == std::floor(value) ? fmt::format("{:.0f}", value) : fmt::format("{:.3f}", value);
}

// Techniques that have kernels of their own, by the settings that name them. The first of each needs none.
constexpr std::array<std::string_view, 3> kTechniqueSettings = {"shadows", "shading", "occlusion"};

// The kernels of one integrator for a scene, each set once, however many settings ask for it.
class Compilation {
public:
  Compilation(Device& device, std::vector<CompiledKernel>& kernels)
      : device_(device), compiler_(device), kernels_(kernels) {}

  // Adds what the integrator begins to compile, without what it begins for other scenes.
  void add(gpu::Feature features, const RenderPlan& settings, const std::string& name) {
    settings.integrator->start_kernels(compiler_, device_.info(), features, settings);
    const gpu::Feature wanted = kernel_config(features, kExpectedStack, settings).features;
    const bool by_query = traces_by_query(traversal_of(settings), device_.info());
    for (const KernelSet* set : compiler_.all()) {
      if (set->config().features != wanted || !added_.insert(set).second) continue;
      const KernelNeed& need = set->need();
      std::map<std::string_view, int> met; // some kernels of a set share a name, as of a stage whose times are added up
      for (std::size_t stage = 0; stage < need.program->stages.size(); ++stage) {
        const KernelCode& code = need.program->stages[stage];
        if (!(need.stages >> stage & 1u) || (by_query && code.query.empty())) continue; // listed without queries
        const int number = ++met[code.name];
        kernels_.push_back({number == 1 ? code.name : fmt::format("{} {}", code.name, number), name,
                            kernel_statistics(device_, (*set)[stage])});
      }
    }
  }

private:
  Device& device_;
  KernelCompiler compiler_;
  std::set<const KernelSet*> added_;
  std::vector<CompiledKernel>& kernels_;
};

} // namespace

std::vector<CompiledKernel> compile_kernels(Device& device, const PackedScene& scene, const RenderPlan& settings,
                                            bool ablate, const std::function<void(const std::string&)>& progress) {
  std::vector<CompiledKernel> kernels;
  const auto compile = [&](Compilation& to, const RenderPlan& variant, const std::string& what, gpu::Feature more = 0) {
    const std::string name = fmt::format("{}{}", variant.integrator->name, what);
    progress(name);
    to.add(scene.features | more, variant, name);
  };
  RenderPlan by_compute = settings;
  by_compute.traversal = kTraversalCompute;
  for (const IntegratorKind* kind : integrators()) {
    if (!kind->start_kernels) continue;
    Compilation compilation(device, kernels);
    RenderPlan variant = by_compute;
    variant.integrator = kind;
    compile(compilation, variant, "");
    variant.specialize = false;
    compile(compilation, variant, ", generic");
    variant.specialize = true;
    for (const std::string_view setting : kTechniqueSettings) {
      if (!supports(*kind, setting)) continue;
      const Setting& row = setting_named(setting);
      for (const std::string_view name : choices_of(row)) {
        RenderPlan chosen = variant;
        read_setting(row, std::string(name), chosen);
        if (!is_default(row, chosen)) compile(compilation, chosen, fmt::format(", {} {}", setting, name));
      }
    }
    if (kind != &default_integrator()) continue;
    const bool samples = (scene.features & gpu::kFeatureSampledTextures) != 0; // all of these do
    if (scene.features & gpu::kFeatureTextures && !samples)
      compile(compilation, variant, ", textures by samplers", gpu::kFeatureSampledTextures);
    if (!device.info().has_ray_queries) continue;
    variant.traversal = kTraversalHardware;
    compile(compilation, variant, ", ray queries");
  }
  if (!ablate) return kernels;
  Compilation compilation(device, kernels);
  for (const LeftOut& entry : scene.left_out) {
    if (!entry.feature) continue; // no code, only data
    RenderPlan variant = by_compute;
    variant.integrator = &default_integrator();
    variant.kernels.added = entry.feature;
    compile(compilation, variant, ", with " + entry.what);
  }
  return kernels;
}

Json compiled_document(const DeviceInfo& device, const std::vector<CompiledKernel>& kernels) {
  Json document = Json::array();
  for (const CompiledKernel& kernel : kernels) {
    Json statistics = Json::object();
    for (const auto& [name, value] : kernel.statistics)
      if (value == std::floor(value) && std::abs(value) < 0x1p53)
        statistics[name] = static_cast<std::int64_t>(value);
      else
        statistics[name] = value;
    document.push_back({{"kernel", kernel.kernel},
                        {"configuration", kernel.configuration},
                        {"device", device.name},
                        {"statistics", std::move(statistics)}});
  }
  return document;
}

std::string compiled_table(const DeviceInfo& device, const std::vector<CompiledKernel>& kernels) {
  std::string text = fmt::format("{}, {}\n", device.name, device.driver);
  std::string configuration;
  for (const CompiledKernel& kernel : kernels) {
    if (kernel.configuration != configuration) text += fmt::format("\n{}\n", configuration = kernel.configuration);
    std::string line = fmt::format("  {:<16}", kernel.kernel);
    for (const auto& [name, value] : kernel.statistics)
      if (is_told(name)) line += fmt::format("  {} {}", name, number(value));
    text += line + "\n";
  }
  return text;
}

} // namespace wavepath
