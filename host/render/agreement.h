// Checks that two candidates agree on light that both must find. If they do not, one of them is wrong.
#pragma once

#include <optional>

#include "host/render/render.h"

namespace wavepath {

struct Disagreement {
  double fraction = 0.0;       // (second - first) / brighter of the two, of the whole picture's light
  double standard_error = 0.0; // standard error of `fraction`
};

// True if candidates may differ by design. A path that a normal map would bend below the surface of a mirror is folded
// back (kernels/surface/world_scattering.glsl). It cannot be followed from the light, so `bidirectional` cuts it off,
// and `path` does not.
bool folds_mirrors(const PackedScene& scene);

// Renders pilots by both candidates with one bounce, and returns how much they differ; empty if they agree. Light that
// has scattered once has met no mirror and no smooth glass on its way from a lamp. So every correct candidate finds all
// of it, unless mirrors are folded. A difference counts if it exceeds four standard errors and 1 %. A second pilot,
// with another seed and four times the samples, must confirm it with the same sign.
std::optional<Disagreement> find_disagreement(Device& device, const PackedScene& scene, const View& view,
                                              const RenderPlan& first, const RenderPlan& second,
                                              KernelCompiler& kernels, SceneOnDevice& shared);

// True if each of two pictures of equal size is brighter than the other, by more than four standard errors, in some
// block of 4x4 pixels. A picture that only lacks light is darker everywhere. Not valid where mirrors are folded.
bool differ_both_ways(const Film& a, const Film& b);

} // namespace wavepath
