// Whether two candidates find the same light where neither can lack any: if not, one of them is wrong.
#pragma once

#include <optional>

#include "host/render/render.h"

namespace wavepath {

struct Disagreement {
  double fraction = 0.0;       // by which the second is brighter than the first, over the brighter one
  double standard_error = 0.0; // of that
};

// Whether ways may differ by design: what a mirror with a normal map folds up (kernels/surface/world_scattering.glsl)
// cannot be followed back from the light, so that `bidirectional` cuts it off, and `path` does not.
bool folds_mirrors(const PackedScene& scene);

// Renders pilots by both with one bounce. Light that is scattered once has met neither mirror nor smooth glass
// on its way from a lamp, so that every complete way finds all of it, unless mirrors are folded: what differs by more
// than four standard errors and a percent, in a second pilot with another seed and four times the samples as well, and
// to the same side, is no chance. Nothing where they agree.
std::optional<Disagreement> find_disagreement(Device& device, const PackedScene& scene, const View& view,
                                              const RenderPlan& first, const RenderPlan& second,
                                              KernelCompiler& kernels, SceneOnDevice& shared);

// Whether each of two pictures of the same size is brighter in some block of 4x4 than the other by more than four
// standard errors. Light that one of them lacks makes it darker alone. Not to be asked where mirrors are folded.
bool differ_both_ways(const Film& a, const Film& b);

} // namespace wavepath
