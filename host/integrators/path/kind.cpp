#include "host/integrators/path/kind.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/integrators/path/guiding.h"
#include "host/integrators/path/light_histograms.h"
#include "host/integrators/path/path_tracer.h"
#include "host/integrators/path/sky_histograms.h"
#include "host/render/render.h"
#include "host/render/settings/cover.h"
#include "host/render/settings/direct_sampling.h"
#include "host/render/settings/light_groups.h"
#include "host/render/settings/path_reuse.h"

namespace wavepath {
namespace {

constexpr std::array<std::string_view, 16> kSettings = {
    "hemisphere", "direct",  "lights",     "path sampling", "adaptive",     "guide", "lens",        "denoise",
    "pixel",      "shutter", "terminator", "aov-through",   "light-groups", "clamp", "transparent", "velocity"};
// It tries guiding, replays no path, and compares integrators that find all light.
constexpr std::array<std::string_view, 3> kNotByAuto = {"guide", "pixel", "clamp"};
constexpr std::array<std::string_view, 2> kFirstHitStages = {"generate", "extend"};

void start_kernels(KernelCompiler& kernels, const DeviceInfo& device, gpu::Feature features,
                   const RenderPlan& settings) {
  kernels.start(path_need(kPathProgram, kAllPathStages, kernel_config(features, kExpectedStack, settings)));
  if (!generic_first(device)) return;
  kernels.start(path_need(kPathProgram, kAllPathStages, generic_config(features, kExpectedStack, settings)));
}

void check(const RenderPlan& settings) {
  if (compares_light(settings) && settings.direct != gpu::kDirectMis)
    throw UsageError(settings.catches ? "--catcher" : "--aov shadow",
                     "compares light with what would arrive if nothing blocked it, as --direct mis finds it",
                     "leave out --direct");
  if (settings.reuse != kReuseOn) return;
  if (has_cover(settings))
    throw UsageError("--reuse", "shares light between pixels, but not what is transparent or in shadow",
                     "leave it out, or --transparent, --catcher and --aov shadow,environment");
  if (settings.guide)
    throw UsageError("--reuse", "weighs paths by the BSDF's density, not by that of a guiding field",
                     "leave out --guide or --reuse");
  if (settings.hemisphere != gpu::kHemisphereCosine)
    throw UsageError("--reuse", "weighs diffuse directions by the cosine", "leave out --hemisphere uniform or --reuse");
  if (records_groups(settings))
    throw UsageError("--reuse", "does not tell from which light comes what neighbours found",
                     "leave out --light-groups or --reuse");
}

std::vector<std::string> bias(const RenderPlan& settings, const RenderResult&) {
  std::vector<std::string> sentences = {
      fmt::format("light paths end after {} bounces (--max-depth)", settings.max_depth)};
  if (settings.catches)
    sentences.emplace_back("shadows on the catcher have one alpha for all colours, a ratio of two means (--catcher)");
  return sentences;
}

std::vector<MemoryItem> memory_items(const RenderPlan& settings, const ScenePlan&, gpu::Feature) {
  return {{"guiding field", settings.guide ? kGuideBytes : 0}};
}

std::uint64_t slot_bytes(gpu::Feature features, const RenderPlan& settings, std::uint32_t more_capacity) {
  features |= features_of(settings) & gpu::kFeatureAdaptive;
  const DirectSampling sampling = direct_sampling(with_most_sky(settings, features), features);
  if (features & gpu::kFeatureEnvironmentMap || sampling.sky > 1)
    features |= features_of(settings) & gpu::kFeatureLearnedSky;
  return group_bytes_per_slot(settings) +
         bytes_per_path(features, kCapacityForShadowRays | kCapacityForSortedRays | more_capacity, sampling.queues());
}

std::uint64_t bytes_per_slot(gpu::Feature features, const RenderPlan& settings) {
  return slot_bytes(features, settings, kernels_reuse_paths(settings, features) ? kCapacityForReuse : 0);
}

std::vector<MemoryItem> slot_items(gpu::Feature features, const RenderPlan& settings) {
  return {{"records for neighbours", bytes_per_slot(features, settings) - slot_bytes(features, settings, 0)},
          {"light of groups", group_bytes_per_slot(settings)}};
}

std::vector<OmittedStage> omitted(const RenderPlan& settings) {
  std::vector<OmittedStage> left_out;
  if (!reuses_paths(settings) && settings.kernels.reuse == BearsReuse::nowhere)
    left_out.push_back({"what pixels tell their neighbours of paths, and its kernel", "no reuse of paths"});
  if (!settings.guide) left_out.push_back({"guiding field, its pilot and its kernels", "--guide was not given"});
  if (!(features_of(settings) & gpu::kFeatureLearnedSky))
    left_out.push_back({"learned parts of the sky", "--lights or --direct does not ask for them"});
  return left_out;
}

std::vector<RenderPlan> candidates(const RenderPlan& settings, const PackedScene&) {
  RenderPlan plain = settings;
  plain.integrator = &kPath;
  RenderPlan guided = plain;
  guided.guide = true;
  return {plain, guided};
}

// Work of these rays, in camera rays: shadow rays end at the first hit. Rays of pilots are counted separately.
double work(const RenderPlan& settings, const RayCounts& rays, DeviceClass device) {
  const double guided =
      settings.guide ? (is_cpu(device) ? 1.45 : 1.4) : 1.0; // shade reads the field: 1.3 to 1.85 on llvmpipe
  // Work of reuse besides its rays, for storing and weighing vertices: 0.1 to 1 of a camera ray (llvmpipe).
  const double shared = reuses_paths(settings) ? 0.6 * static_cast<double>(rays.camera) : 0.0;
  return shared + guided * (static_cast<double>(rays.camera + rays.bounce) + 0.6 * static_cast<double>(rays.shadow));
}

} // namespace

constinit const IntegratorKind kPath = {
    .name = "path",
    .summary = "path tracing",
    .settings = kSettings,
    .aovs = kCoverAovs,
    .passes_panes = true,
    .nests_bodies = true,
    .sorts_hits = true,
    .light_training_bytes = kLightCellBytes + kLightSumBytes,
    .sky_training_bytes = kSkyCellBytes + kSkySumBytes,
    .measures_depth_cut = true,
    .first_hit_stages = kFirstHitStages,
    .check = check,
    .features = film_features,
    .start_kernels = start_kernels,
    .bytes_per_slot = bytes_per_slot,
    .largest_record =
        [](const RenderPlan& settings) {
          return std::max<std::uint64_t>({2 * sizeof(gpu::Ray), sizeof(gpu::PathAovs), kMostShadowRayBytes,
                                          gpu::kMostReuseTexels * sizeof(glm::uvec4), group_bytes_per_slot(settings)});
        },
    .slot_items = slot_items,
    .slots_per_pixel = [](const RenderPlan&) { return 1u; },
    .bytes_per_pixel = [](const RenderPlan&) { return std::uint64_t{0}; },
    .items = memory_items,
    .is_biased = [](const RenderPlan&) { return false; },
    .bias = bias,
    .omitted = omitted,
    .stats = [](const RenderPlan&, const PackedScene&, const RenderResult&) { return nlohmann::ordered_json(); },
    .make = [](Workspace& workspace, KernelCompiler& kernels) -> std::unique_ptr<Integrator> {
      return std::make_unique<PathTracer>(workspace, kernels);
    },
    .candidates = candidates,
    .not_by_auto = kNotByAuto,
    .work = work,
};

} // namespace wavepath
