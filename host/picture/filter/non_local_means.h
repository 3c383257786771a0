// Non-local means (Buades et al. 2005) driven by the variance of every pixel (Rousselle et al. 2012), among pixels of
// one surface (after Rousselle et al. 2013).
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "host/picture/filter/surface_guides.h"

namespace wavepath {

// `color` of every pixel of a picture that is `width` wide becomes the mean of those whose surroundings look alike, as
// far as `variance`, of the three channels together, lets that be told.
std::vector<glm::vec3> non_local_means(std::size_t width, const std::vector<glm::vec3>& color,
                                       const std::vector<float>& variance, const std::vector<SurfaceGuide>& guides);

} // namespace wavepath
