// What is wrong with a picture: light that is missing or biased, samples that were left out, its error against another.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/picture/picture.h"
#include "host/render/depth_cut.h"
#include "host/render/lost_light.h"
#include "host/render/render.h"
#include "host/render/report/true_error.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {

// Measurements of missing light, if they were asked for, or the reasons why they failed.
struct MissingLight {
  std::optional<DepthCut> cut;   // light beyond --max-depth
  std::optional<LostLight> lost; // light that paths from the camera cannot find
  std::string no_cut, no_lost;   // why they were not measured; empty = they were, or nobody asked
};

// Every reason why the expected picture is not the full light transport of the scene, a sentence each.
std::vector<std::string> list_bias(const RenderPlan& settings, const PackedScene& scene, const RenderResult& result,
                                   const MissingLight& missing = {});

// `bias`, joined by "; ", with the share of the light that --clamp took from the samples of this film.
std::string with_clamp_share(const std::string& bias, const Film& film);

// The first sample that was not finite and how to replay it. There must be one.
std::string describe_first(const Nonfinite& nonfinite, const RenderPlan& settings);

TrueError measure_true_error(const Picture& picture, const Picture& reference);

} // namespace wavepath
