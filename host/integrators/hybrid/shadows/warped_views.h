// Views of suns whose texels are smaller where the camera is near: the plane at right angles to the light, seen in
// perspective. Light still arrives along parallel rays, a texel each. To an orthographic camera all is equally near.
#pragma once

#include <optional>

#include "host/integrators/hybrid/shadows/views.h"

namespace wavepath {

// View of light-space perspective shadow maps (Wimmer, Scherzer and Purgathofer 2004). `distance`: from the
// perspective's eye to the visible part, as a multiple of that part's extent along the camera's axis; infinity =
// parallel_view(); empty = the distance that spreads the error best.
gpu::ShadowView light_space_perspective_view(const ShadowFit& fit, const glm::dvec3& direction, const View& view,
                                             std::optional<double> distance);

// View of trapezoidal shadow maps (Martin and Tan 2004): the nearest quarter of the depths gets four fifths of the map.
gpu::ShadowView trapezoidal_view(const ShadowFit& fit, const glm::dvec3& direction, const View& view);

// View of perspective shadow maps (Stamminger and Drettakis 2002): the light's view of the camera's image space. The
// camera steps back as far as it must for that space to show all receivers on one side of the light.
gpu::ShadowView camera_space_view(const ShadowFit& fit, const glm::dvec3& direction, const View& view);

} // namespace wavepath
