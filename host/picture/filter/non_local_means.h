// Non-local means (Buades et al. 2005) driven by the variance of every pixel (Rousselle et al. 2012), among pixels of
// one surface (after Rousselle et al. 2013).
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "host/picture/filter/surface_guides.h"

namespace wavepath {

// Replaces `color` of every pixel by the mean of those pixels whose neighbourhoods look alike, as far as `variance`
// lets differences be told from noise. `width`: of the picture, whose values are row-major. `variance`: sum over the
// three channels of the variance of a pixel's mean.
std::vector<glm::vec3> non_local_means(std::size_t width, const std::vector<glm::vec3>& color,
                                       const std::vector<float>& variance, const std::vector<SurfaceGuide>& guides);

} // namespace wavepath
