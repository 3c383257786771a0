// Views of lights: frusta fitted to casters and receivers of shadows.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "host/integrators/hybrid/raster/culling.h"
#include "host/integrators/hybrid/shadows/source.h"
#include "host/scene/staging/view.h"
#include "kernels/hybrid/shadows/shadow_types.h"

namespace wavepath {

inline constexpr double kFitPadding = 1e-4; // padding, relative to the fitted extent

// Extents to fit views to, in the device's world space, metres.
struct ShadowFit {
  glm::dvec3 lo{0.0}, hi{0.0};          // box of all casters
  double radius = 0.0;                  // radius of the scene
  std::vector<glm::dvec3> receivers;    // corners of a convex body around everything that the camera sees
  std::uint32_t size = 0;               // texels along a side of a view
  double guard = 0.0;                   // margin in texels, for filters
  double nearest = 0.0, farthest = 0.0; // range of camera depths that contains the receivers
};

// Corners of the part of the box that the camera sees between two depths; empty if there is none. `view`: in the
// device's world space.
std::vector<glm::dvec3> seen_corners(const View& view, const glm::dvec3& lo, const glm::dvec3& hi, double nearest,
                                     double farthest);

// A parallel view that shows the receivers, and everything between them and the light.
gpu::ShadowView parallel_view(const ShadowFit& fit, const glm::dvec3& direction);
// The same, but only as wide as `shown`, a part of the receivers; as deep as all receivers.
gpu::ShadowView parallel_view(const ShadowFit& fit, const glm::dvec3& direction, std::span<const glm::dvec3> shown);

// A perspective view from a point. `tangent`: of its half angle. `radius`: of a lamp around the point. `first`: depth
// before which nothing casts a shadow, if it is more than the minimum.
gpu::ShadowView perspective_view(const ShadowFit& fit, const glm::dvec3& position, const glm::dvec3& forward,
                                 const glm::dvec3& up, double tangent, double radius = 0.0, double first = 0.0);

// Six views that together show all directions, from a point or from the middle of a sphere, which they do not show.
std::vector<gpu::ShadowView> cube_views(const ShadowFit& fit, const glm::dvec3& position, double radius = 0.0);

// Two views that do so, as paraboloid mirrors: of the half space below the light, where most lit surfaces are, and of
// that above.
std::vector<gpu::ShadowView> paraboloid_views(const ShadowFit& fit, const glm::dvec3& position);

// The usual views of a source: parallel for suns; one perspective for spots, rectangles and discs, from the centre; a
// cube for points, spheres and wide spots.
std::vector<gpu::ShadowView> usual_views(const ShadowFit& fit, const ShadowSource& source);

// Half spaces that a box must reach into to be visible in a view.
std::vector<HalfSpace> frustum_of(const gpu::ShadowView& view);

} // namespace wavepath
