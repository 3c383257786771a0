#include "host/integrators/whitted/kind.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/integrators/whitted/whitted.h"
#include "host/scene/pack/features.h"

namespace wavepath {
namespace {

constexpr std::array<std::string_view, 8> kSettings = {"adaptive", "ambient", "branching",  "cutoff",
                                                       "denoise",  "lens",    "terminator", "velocity"};
constexpr std::array<std::string_view, 2> kFirstHitStages = {"whitted begin", "whitted trace"};

void start_kernels(KernelCompiler& kernels, const DeviceInfo&, gpu::Feature features, const RenderPlan& settings) {
  const KernelConfig config = kernel_config(features, kExpectedStack, settings);
  kernels.start({&kWhittedProgram, kWhittedStages, config});
  kernels.start({&kPathProgram, stage_bits({kAccumulate}), config});
}

std::vector<std::string> bias(const RenderPlan& settings, const RenderResult&) {
  std::vector<std::string> bias = {fmt::format(
      "light that more than one rough surface has scattered is left out, and so is what rough surfaces mirror of "
      "others; mirrors and glass are followed for {} bounces (--integrator whitted, --max-depth)",
      settings.max_depth)};
  if (settings.cutoff > 0.0)
    bias.push_back(fmt::format("rays of weight {:.3g} and less are not followed (--cutoff)", settings.cutoff));
  if (settings.ambient)
    bias.push_back(fmt::format("an ambient term of radiance {:.3g},{:.3g},{:.3g} stands for other light (--ambient)",
                               settings.ambient->r, settings.ambient->g, settings.ambient->b));
  return bias;
}

std::vector<OmittedStage> omitted(const RenderPlan&) {
  return {{"path kernels generate, extend, shade and connect, and their queues",
           "its own kernels follow the trees of rays"}};
}

} // namespace

constinit const IntegratorKind kWhitted = {
    .name = "whitted",
    .summary = "Whitted's ray tracer, with direct light, mirrors and glass",
    .settings = kSettings,
    .walks_light_tree = false,
    .passes_panes = true,
    .first_hit_stages = kFirstHitStages,
    .unsupported_reason = [](const RenderPlan&, const PackedScene& scene) -> std::string {
      if (scene.features & gpu::kFeatureSoftLamps)
        return "lights by one ray to each lamp, which has no extent (--sun-angle, --lamp-radius)";
      return lacked_lobes(scene, kWhittedLacks);
    },
    .features = film_features,
    .start_kernels = start_kernels,
    .bytes_per_slot =
        [](gpu::Feature features, const RenderPlan&) {
          return bytes_per_path(features, kStatesAlone) + sizeof(gpu::WhittedNode);
        },
    .largest_record = [](const RenderPlan&) { return std::uint64_t{sizeof(gpu::WhittedNode)}; },
    .slots_per_pixel = tree_width,
    .bytes_per_pixel = [](const RenderPlan&) { return std::uint64_t{0}; },
    .is_biased = [](const RenderPlan&) { return true; },
    .bias = bias,
    .omitted = omitted,
    .stats = [](const RenderPlan&, const PackedScene&, const RenderResult&) { return nlohmann::ordered_json(); },
    .make = [](Workspace& workspace, KernelCompiler& kernels) -> std::unique_ptr<Integrator> {
      return std::make_unique<Whitted>(workspace, kernels);
    },
};

} // namespace wavepath
