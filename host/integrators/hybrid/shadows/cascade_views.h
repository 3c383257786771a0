// Cascades: divides the camera's depth range into parts, and fits a view of a sun to each.
#pragma once

#include <vector>

#include "host/integrators/hybrid/shadows/views.h"

namespace wavepath {

// Depths at which the parts begin, and the depth at which the last one ends: parts + 1 values. They lie half-way
// between equal parts and parts of equal ratio (Zhang et al. 2006, weight 0.5). A depth of 0 has no ratio, so the range
// counts from 1/1000 of its end on.
std::vector<double> split_depths(double nearest, double farthest, std::uint32_t parts);

// A view for every part that is not empty of what the camera sees, the nearest first.
std::vector<gpu::ShadowView> cascade_views(const ShadowFit& fit, const glm::dvec3& direction, const View& view,
                                           std::uint32_t parts);

// The part of a parallel view between two positions, which range from -1 to 1 across the view.
gpu::ShadowView cropped_view(const gpu::ShadowView& view, const glm::dvec2& lo, const glm::dvec2& hi,
                             std::uint32_t size);
// A view that shows no point.
gpu::ShadowView blind_view(const gpu::ShadowView& view);

} // namespace wavepath
