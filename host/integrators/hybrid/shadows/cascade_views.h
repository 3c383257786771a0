// The camera's depths in parts, and a view of a sun for each of them.
#pragma once

#include <vector>

#include "host/integrators/hybrid/shadows/views.h"

namespace wavepath {

// Where `parts` parts of a range of depths begin, and where the last one ends: parts + 1 depths. Half-way between equal
// parts and parts of equal ratio (Zhang et al. 2006, weight 0.5). A depth of 0 has no ratio to others, so that the
// range counts from a thousandth of its end on.
std::vector<double> split_depths(double nearest, double farthest, std::uint32_t parts);

// A view for every part of what the camera sees that is not empty, the nearest one first.
std::vector<gpu::ShadowView> cascade_views(const ShadowFit& fit, const glm::dvec3& direction, const View& view,
                                           std::uint32_t parts);

// The part of a parallel view between two positions, which run from -1 to 1 across it.
gpu::ShadowView cropped_view(const gpu::ShadowView& view, const glm::dvec2& lo, const glm::dvec2& hi,
                             std::uint32_t size);
// A view that shows no point.
gpu::ShadowView blind_view(const gpu::ShadowView& view);

} // namespace wavepath
