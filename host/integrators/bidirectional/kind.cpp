#include "host/integrators/bidirectional/kind.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/integrators/bidirectional/bidirectional.h"
#include "host/integrators/path/light_histograms.h"
#include "host/render/loop/render_result.h"
#include "host/render/settings/light_groups.h"
#include "host/scene/pack/features.h"

namespace wavepath {
namespace {

constexpr std::array<std::string_view, 8> kSettings = {"hemisphere", "lights",       "techniques",  "lens",
                                                       "denoise",    "light-groups", "transparent", "velocity"};
constexpr std::array<std::string_view, 1> kAovs = {"environment"};
constexpr std::array<std::string_view, 1> kNotByAuto = {"techniques"};
// Light splatted from a light path is not told apart by its bounces.
constexpr std::array<std::string_view, 2> kLackedAovs = {"direct", "indirect"};
constexpr std::array<std::string_view, 2> kFirstHitStages = {"generate", "extend"};

void start_kernels(KernelCompiler& kernels, const DeviceInfo&, gpu::Feature features, const RenderPlan& settings) {
  // Packing alone tells whether many lights are in many locations. A wrong guess, as of a lamp of many triangles, would
  // cost 1.6 of 5.5 user seconds (showcase, 192x108, 12 samples, llvmpipe); waiting costs what packing takes.
  if (settings.lights == gpu::kLightsAuto && walks_light_tree(settings) && features & gpu::kFeatureLightTree) return;
  const KernelConfig config = kernel_config(features, kExpectedStack, settings);
  kernels.start(bidirectional_need(config));
  kernels.start({&kPathProgram, kSharedPathStages, config});
}

// Its direct light comes by several techniques, of which not all know what nothing would block.
void check(const RenderPlan& settings) {
  if (settings.catches)
    throw UsageError("--catcher", "is not known to --integrator bidirectional", "use --integrator path");
}

// Merging converges to the light of all paths, as its radius shrinks to nothing.
bool is_biased(const RenderPlan& settings) {
  return (settings.techniques | gpu::kTechniqueMerge) != gpu::kTechniquesAll;
}

std::vector<std::string> bias(const RenderPlan& settings, const RenderResult& result) {
  std::vector<std::string> bias;
  bias.push_back(fmt::format("light paths end after {} bounces (--max-depth)", settings.max_depth));
  if (result.merging)
    bias.push_back(
        fmt::format("caustics seen through glass or in mirrors are blurred over {:.2g} m, {:.2g} m in the latest "
                    "samples (--techniques merge)",
                    result.merging->first_radius, result.merging->last_radius));
  if (is_biased(settings)) bias.emplace_back("light that only other techniques find is left out (--techniques)");
  return bias;
}

std::vector<OmittedStage> omitted(const RenderPlan& settings) {
  std::vector<OmittedStage> omitted = {{"path kernel shade", "its own kernels shade camera paths and light paths"}};
  if (!asks_for_photons(settings))
    omitted.push_back({"photons, their map and its kernels", "--techniques or --max-depth leaves out merging"});
  return omitted;
}

// Where nothing asks for what it leaves out. Without merging: what is taken without being asked for is not biased.
std::vector<RenderPlan> candidates(const RenderPlan& settings, const PackedScene& scene) {
  if (settings.adaptive == kAdaptiveOn || !settings.aovs.empty() || settings.catches || settings.moving ||
      settings.terminator != gpu::kTerminatorFacets || scene.features & kBidirectionalLacks)
    return {};
  RenderPlan unbiased = settings;
  unbiased.integrator = &kBidirectional;
  unbiased.techniques &= ~gpu::kTechniqueMerge;
  return {unbiased};
}

// 1.0 to 1.95 times what path tracing takes for as many rays (eleven scenes of benchmarks/light_table.py; llvmpipe).
double work(const RenderPlan&, const RayCounts& rays, DeviceClass) {
  return 1.5 * (static_cast<double>(rays.camera + rays.bounce) + 0.6 * static_cast<double>(rays.shadow));
}

} // namespace

constinit const IntegratorKind kBidirectional = {
    .name = "bidirectional",
    .summary = "paths from the camera and from lights, joined in all ways; photons for caustics",
    .settings = kSettings,
    .aovs = kAovs,
    .lacks_aovs = kLackedAovs,
    .nests_bodies = true,
    .splats = true,
    .light_training_bytes = kLightCellBytes + kLightSumBytes,
    .measures_depth_cut = true,
    .first_hit_stages = kFirstHitStages,
    .check = check,
    .unsupported_reason = [](const RenderPlan&,
                             const PackedScene& scene) { return lacked_lobes(scene, kBidirectionalLacks); },
    .features = film_features,
    .start_kernels = start_kernels,
    .bytes_per_slot =
        [](gpu::Feature features, const RenderPlan& settings) {
          if (!walks_light_tree(settings)) features &= ~gpu::kFeatureLightTree;
          return group_bytes_per_slot(settings) + bytes_per_path(features, kCapacityForShadowRays) +
                 light_bytes_per_slot(settings, asks_for_photons(settings));
        },
    .largest_record =
        [](const RenderPlan& settings) {
          return std::max<std::uint64_t>(
              {light_vertex_bytes_per_slot(settings), sizeof(gpu::PathAovs), group_bytes_per_slot(settings)});
        },
    .slot_items = [](gpu::Feature, const RenderPlan& settings) -> std::vector<MemoryItem> {
      return {{"light vertices", light_vertex_bytes_per_slot(settings)},
              {"light of groups", group_bytes_per_slot(settings)}};
    },
    .slots_per_pixel = [](const RenderPlan&) { return 1u; },
    .bytes_per_pixel = [](const RenderPlan&) { return std::uint64_t{0}; },
    .items = [](const RenderPlan& settings, const ScenePlan& scene, gpu::Feature features) -> std::vector<MemoryItem> {
      const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
      return {{"photons", may_have_photons(settings, scene, features) ? plan_photons(pixels).bytes() : 0}};
    },
    .is_biased = is_biased,
    .bias = bias,
    .omitted = omitted,
    .stats = [](const RenderPlan&, const PackedScene&, const RenderResult&) { return nlohmann::ordered_json(); },
    .make = [](Workspace& workspace, KernelCompiler& kernels) -> std::unique_ptr<Integrator> {
      return std::make_unique<Bidirectional>(workspace, kernels);
    },
    .candidates = candidates,
    .not_by_auto = kNotByAuto,
    .work = work,
};

} // namespace wavepath
