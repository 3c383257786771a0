// Decides whether a render trains light selection, or parts of the sky, before its first sample.
#pragma once

#include <cstdint>

#include "host/render/settings/render_plan.h"

namespace wavepath {

struct PackedScene;
struct ScenePlan;

// Paths of training in a part of a render, and in a pilot (Training::paths of 0).
inline constexpr std::uint64_t kPartTrainingPaths = 1u << 16;

// What of a scene decides about training: known of a packed scene, foretold by its plan.
struct TrainingScene {
  TrainingScene(const PackedScene& scene);
  TrainingScene(const ScenePlan& scene, gpu::Feature expected);

  gpu::Feature features; // kFeature bits of the scene
  bool has_light_tree, has_map;
};

// True if lights are chosen with probabilities that are trained for cells of space.
bool trains_lights(const TrainingScene& scene, const RenderPlan& settings);
// True if directions to a sky of one colour, besides those of paths, are chosen so.
bool trains_one_colour(const TrainingScene& scene, const RenderPlan& settings);
// True if parts of the sky are chosen so, of an environment map or of a sky of one colour.
bool trains_sky(const TrainingScene& scene, const RenderPlan& settings);
// True if any of these is trained.
bool trains_light_selection(const TrainingScene& scene, const RenderPlan& settings);

} // namespace wavepath
