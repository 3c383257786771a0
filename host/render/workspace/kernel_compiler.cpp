#include "host/render/workspace/kernel_compiler.h"

#include <algorithm>
#include <bit>

#include "host/render/settings/adaptivity.h"
#include "host/render/settings/direct_sampling.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/mips.h"
#include "host/render/settings/path_reuse.h"
#include "host/render/settings/probing.h"
#include "host/render/settings/shadow_settings.h"
#include "host/render/settings/traversal.h"

namespace wavepath {
namespace {

// Stack sizes come in steps, so that one set of kernels fits most scenes: unused entries cost nothing that could be
// measured (33 to 128 entries, llvmpipe).
constexpr std::uint32_t kStackStep = 64;

std::uint32_t lens_of(const RenderPlan& settings) {
  if (!(settings.lens.aperture > 0.0) || !supports(*settings.integrator, "aperture")) return gpu::kLensPinhole;
  return settings.lens.blades > 0 ? settings.lens.blades : gpu::kLensDisc;
}

} // namespace

gpu::Feature generic_features(gpu::Feature scene) {
  return gpu::kFeaturesAll | gpu::kFeatureLearnedSky | gpu::kFeatureAovsThrough | gpu::kLobeMultiple |
         (scene & gpu::kLobesLayered ? gpu::kLobesLayered : 0) |
         (scene & (gpu::kFeatureMips | gpu::kFeatureTexelPages | gpu::kFeatureSampledTextures |
                   gpu::kFeatureExactTextures | gpu::kFeatureWalls | gpu::kFeatureCameraModel | gpu::kFeatureSoftLamps |
                   gpu::kFeatureLightProfiles | gpu::kFeatureLightGroups | gpu::kFeatureCover | gpu::kFeatureVoxels |
                   gpu::kFeatureFire | gpu::kFeatureRelativity));
}

KernelConfig kernel_config(gpu::Feature features, std::uint32_t stack_size, const RenderPlan& settings) {
  const std::uint32_t stack = (stack_size + kStackStep - 1) / kStackStep * kStackStep;
  const DirectSampling sampling = direct_sampling(settings, features);
  const bool reuse = kernels_reuse_paths(settings, features);
  if (!settings.specialize) features = generic_features(features);
  // Generic kernels, too, leave out what the settings do not ask for.
  constexpr gpu::Feature kByRequest = gpu::kFeatureAovs | gpu::kFeatureAovsThrough | gpu::kFeatureAdaptive |
                                      gpu::kFeatureSharedFirstHit | gpu::kFeatureLightCells | gpu::kFeatureLearnedSky |
                                      gpu::kFeatureGuide | gpu::kFeatureLightGroups;
  features &= ~kByRequest | features_of(settings);
  if (!walks_light_tree(settings)) features &= ~gpu::kFeatureLightTree;
  if (!(features & gpu::kFeatureLightTree)) features &= ~gpu::kFeatureLightCells;
  if (!passes_panes(settings)) features &= ~(gpu::kFeaturePanes | gpu::kFeatureWalls);
  if (!settings.integrator->nests_bodies) features &= ~gpu::kLobeNested;
  if (!wants_mips(settings)) features &= ~gpu::kFeatureMips;
  features = (features | settings.kernels.added) & ~settings.kernels.removed;
  if (!(features & gpu::kFeatureEnvironmentMap) && !sampling.kernels_see_sky) features &= ~gpu::kFeatureLearnedSky;
  const std::uint32_t probing =
      has_error_probes(settings) || settings.kernels.has_probes ? gpu::kProbingOn : gpu::kProbingOff;
  const std::uint32_t motion = settings.moving && supports(*settings.integrator, "shutter") ? 1u : 0u;
  // A path that leaves the scene sees the environment, and ends a record on which guiding trains.
  const bool escapes =
      settings.guide || features & (gpu::kFeatureEnvironment | gpu::kFeatureSoftLamps | gpu::kFeatureCover);
  const bool sorts = settings.integrator->sorts_hits && !(features & gpu::kFeatureVoxels); // which decide later
  const std::uint32_t sort = !sorts ? gpu::kSortNone : escapes ? gpu::kSortEscapes : gpu::kSortHits;
  const std::uint32_t terminator =
      supports(*settings.integrator, "terminator") ? settings.terminator : gpu::kTerminatorFacets;
  const std::uint32_t clamp =
      supports(*settings.integrator, "clamp") ? std::bit_cast<std::uint32_t>(static_cast<float>(settings.clamp)) : 0u;
  return {features,
          stack,
          settings.sampler,
          direct_of(settings),
          settings.hemisphere,
          settings.filter,
          probing,
          lens_of(settings),
          settings.cull,
          motion,
          terminator,
          traversal_of(settings),
          sort,
          sampling.lights,
          sampling.kernels_see_sky ? gpu::kSkyByShadowRays : gpu::kSkyByPaths,
          reuse ? gpu::kReuseQuads : gpu::kReuseNone,
          clamp};
}

KernelConfig generic_config(gpu::Feature scene, std::uint32_t stack_size, const RenderPlan& settings) {
  const KernelConfig specialized = kernel_config(scene, stack_size, settings);
  KernelConfig generic = kernel_config(generic_features(scene), stack_size, settings);
  generic.light_samples = specialized.light_samples; // what generic kernels are not compiled for
  generic.sky = specialized.sky;
  generic.reuse = specialized.reuse;
  return generic;
}

gpu::Feature features_of(const RenderPlan& settings) {
  gpu::Feature features = is_adaptive(settings) ? gpu::kFeatureAdaptive : 0;
  const bool learned = settings.lights == gpu::kLightsLearned || settings.lights == gpu::kLightsAuto;
  if (learned && settings.integrator->light_training_bytes > 0) features |= gpu::kFeatureLightCells;
  if (learned && settings.integrator->sky_training_bytes > 0 && settings.max_depth > 0 &&
      direct_of(settings) != gpu::kDirectBsdf)
    features |= gpu::kFeatureLearnedSky;
  return features | settings.integrator->features(settings);
}

bool walks_light_tree(const RenderPlan& settings) {
  const bool connects = !supports(*settings.integrator, "techniques") || settings.techniques & gpu::kTechniqueLight;
  return settings.integrator->walks_light_tree && settings.lights != gpu::kLightsPower && connects;
}

bool passes_panes(const RenderPlan& settings) {
  return settings.integrator->passes_panes && settings.direct != gpu::kDirectBsdf && settings.max_depth > 1;
}

bool generic_first(const DeviceInfo& device) { return device.type != "cpu"; }

void KernelCompiler::start(const KernelNeed& need) {
  const std::lock_guard lock(mutex_);
  for (const Entry& entry : entries_)
    if (entry.made_for == need) return;
  Entry& entry = entries_.emplace_back();
  entry.made_for = need;
  entry.compiling = std::async(std::launch::async, [this, &entry] {
    std::unique_ptr<KernelSet> set;
    std::exception_ptr failure;
    try {
      set = std::make_unique<KernelSet>(device_, entry.made_for);
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard done(mutex_);
    entry.set = std::move(set);
    entry.failure = failure;
    changed_.notify_all();
  });
}

const KernelCompiler::Entry* KernelCompiler::choose(const KernelNeed& need) const {
  const Entry* chosen = nullptr;
  for (const Entry& entry : entries_) {
    if (!entry.made_for.covers(need) || (!entry.set && !entry.failure)) continue;
    if (entry.made_for == need) return &entry;
    if (entry.set) chosen = &entry;
  }
  return chosen;
}

const KernelSet& KernelCompiler::best(const KernelNeed& need) {
  start(need);
  std::unique_lock lock(mutex_);
  const Entry* chosen = nullptr;
  changed_.wait(lock, [&] { return (chosen = choose(need)) != nullptr; });
  if (chosen->failure) std::rethrow_exception(chosen->failure);
  return *chosen->set;
}

bool KernelCompiler::ready(const KernelNeed& need) {
  start(need);
  const std::lock_guard lock(mutex_);
  return choose(need) != nullptr;
}

std::vector<const KernelSet*> KernelCompiler::all() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return std::ranges::all_of(entries_, [](const Entry& e) { return e.set || e.failure; }); });
  std::vector<const KernelSet*> sets;
  for (const Entry& entry : entries_) {
    if (entry.failure) std::rethrow_exception(entry.failure);
    sets.push_back(entry.set.get());
  }
  return sets;
}

gpu::Feature KernelCompiler::features(const KernelProgram& program) const {
  const std::lock_guard lock(mutex_);
  gpu::Feature features = 0;
  for (const Entry& entry : entries_)
    if (entry.made_for.program == &program) features |= entry.made_for.config.features;
  return features;
}

} // namespace wavepath
