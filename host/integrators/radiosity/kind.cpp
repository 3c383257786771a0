#include "host/integrators/radiosity/kind.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/integrators/radiosity/radiosity.h"
#include "host/integrators/radiosity/settings.h"
#include "host/render/loop/render_result.h"
#include "host/scene/pack/features.h"
#include "host/scene/pack/plan.h"

namespace wavepath {
namespace {

constexpr std::array<std::string_view, 7> kSettings = {"patches", "subdivision", "form-factors", "patch-rays",
                                                       "gather",  "lens",        "denoise"};
// Light between corners is not told apart by its bounces.
constexpr std::array<std::string_view, 2> kLackedAovs = {"direct", "indirect"};
constexpr std::array<std::string_view, 1> kFirstHitStages = {"radiosity see"};

void start_kernels(KernelCompiler& kernels, const DeviceInfo&, gpu::Feature features, const RenderPlan& settings) {
  const KernelConfig config = kernel_config(features, kExpectedStack, settings);
  kernels.start(radiosity_need(config, settings));
  kernels.start({&kPathProgram, stage_bits({kAccumulate}), config});
}

std::vector<std::string> bias(const RenderPlan& settings, const RenderResult& result) {
  std::vector<std::string> bias = {
      "surfaces reflect all light diffusely, also what they should mirror, and normal maps bend none that patches "
      "receive (--integrator radiosity)"};
  if (!result.radiosity) return bias;
  bias.push_back(fmt::format("light is {} {} patches (--patches)",
                             settings.gather ? "gathered from the corners of" : "interpolated between the corners of",
                             result.radiosity->patches));
  if (settings.form_factors == kFormFactorsLinks) {
    bias.emplace_back("form factors are inexact where parts of surfaces see each other in part (--form-factors links)");
    if (result.radiosity->remaining > 1e-4)
      bias.push_back(
          fmt::format("the last {:.2g} % of the light was not followed", 100.0 * result.radiosity->remaining));
  } else if (result.radiosity->remaining > 0.0) {
    bias.push_back(fmt::format("an ambient term stands for the last {:.2g} % of the light that patches would send on",
                               100.0 * result.radiosity->remaining));
  }
  return bias;
}

std::vector<OmittedStage> omitted(const RenderPlan& settings) {
  std::vector<OmittedStage> omitted = {
      {"path kernels generate, extend, shade and connect, and their queues", "camera rays end at the patches"}};
  if (!settings.gather) omitted.push_back({"rays of the final gather", "light is interpolated (--gather)"});
  return omitted;
}

} // namespace

constinit const IntegratorKind kRadiosity = {
    .name = "radiosity",
    .summary = "diffuse light between patches of all surfaces, solved once for all views",
    .settings = kSettings,
    .lacks_aovs = kLackedAovs,
    .walks_light_tree = false,
    .first_hit_stages = kFirstHitStages,
    .rows = radiosity_rows,
    .unsupported_reason = radiosity_lacks,
    .features = film_features,
    .start_kernels = start_kernels,
    .bytes_per_slot = [](gpu::Feature features,
                         const RenderPlan&) { return bytes_per_path(features, kStatesAlone) + sizeof(gpu::SeenPoint); },
    .largest_record = [](const RenderPlan&) { return std::uint64_t{sizeof(gpu::SeenPoint)}; },
    .slots_per_pixel = [](const RenderPlan&) { return 1u; },
    .bytes_per_pixel = [](const RenderPlan&) { return std::uint64_t{0}; },
    .items = [](const RenderPlan& settings, const ScenePlan& scene, gpu::Feature) -> std::vector<MemoryItem> {
      return {
          {"patches", patch_bytes(settings.patches, scene.triangles_seen, settings.form_factors == kFormFactorsLinks)}};
    },
    .is_biased = [](const RenderPlan&) { return true; },
    .bias = bias,
    .omitted = omitted,
    .stats = [](const RenderPlan&, const PackedScene&, const RenderResult&) { return nlohmann::ordered_json(); },
    .make = [](Workspace& workspace, KernelCompiler& kernels) -> std::unique_ptr<Integrator> {
      return std::make_unique<Radiosity>(workspace, kernels);
    },
};

} // namespace wavepath
