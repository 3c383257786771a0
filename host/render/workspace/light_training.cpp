#include "host/render/workspace/light_training.h"

#include "host/render/settings/light_samples.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {
namespace {

gpu::Feature kernel_features(const PackedScene& scene, const RenderPlan& settings) {
  return kernel_config(scene.features | features_of(settings), scene.stack_size, settings).features;
}

} // namespace

bool trains_lights(const PackedScene& scene, const RenderPlan& settings) {
  return (kernel_features(scene, settings) & gpu::kFeatureLightCells) != 0 && !scene.light_tree.empty();
}

bool trains_one_colour(const PackedScene& scene, const RenderPlan& settings) {
  return settings.training.one_colour && sky_samples_of(settings, scene.features) > 1 &&
         (kernel_features(scene, settings) & gpu::kFeatureLearnedSky) != 0;
}

bool trains_sky(const PackedScene& scene, const RenderPlan& settings) {
  const bool of_map = !scene.environment_ends.empty() && scene.environment_probability > 0.0f && settings.max_depth > 0;
  return (of_map && (kernel_features(scene, settings) & gpu::kFeatureLearnedSky) != 0) ||
         trains_one_colour(scene, settings);
}

bool trains_light_selection(const PackedScene& scene, const RenderPlan& settings) {
  return trains_lights(scene, settings) || trains_sky(scene, settings);
}

} // namespace wavepath
