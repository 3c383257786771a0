#include "host/render/workspace/light_training.h"

#include "host/render/settings/direct_sampling.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/packed_scene.h"
#include "host/scene/pack/plan.h"

namespace wavepath {
namespace {

gpu::Feature kernel_features(const TrainingScene& scene, const RenderPlan& settings) {
  return kernel_config(scene.features | features_of(settings), kExpectedStack, settings).features;
}

} // namespace

TrainingScene::TrainingScene(const PackedScene& scene)
    : features(scene.features),
      has_light_tree(!scene.light_tree.empty()),
      has_map(!scene.environment_ends.empty() && scene.environment_probability > 0.0f) {}

// Features that are expected of a scene name no light tree: whether there is one, its plan knows better.
TrainingScene::TrainingScene(const ScenePlan& scene, gpu::Feature expected)
    : features(expected), has_light_tree(scene.light_tree_bytes > 0), has_map(scene.environment_bytes > 0) {
  if (has_light_tree) features |= gpu::kFeatureLightTree;
  if (has_map) features |= gpu::kFeatureEnvironment | gpu::kFeatureEnvironmentMap;
}

bool trains_lights(const TrainingScene& scene, const RenderPlan& settings) {
  return (kernel_features(scene, settings) & gpu::kFeatureLightCells) != 0 && scene.has_light_tree;
}

bool trains_one_colour(const TrainingScene& scene, const RenderPlan& settings) {
  return settings.training.one_colour && direct_sampling(settings, scene.features).sky > 1 &&
         (kernel_features(scene, settings) & gpu::kFeatureLearnedSky) != 0;
}

bool trains_sky(const TrainingScene& scene, const RenderPlan& settings) {
  return (scene.has_map && (kernel_features(scene, settings) & gpu::kFeatureLearnedSky) != 0) ||
         trains_one_colour(scene, settings);
}

bool trains_light_selection(const TrainingScene& scene, const RenderPlan& settings) {
  return trains_lights(scene, settings) || trains_sky(scene, settings);
}

} // namespace wavepath
