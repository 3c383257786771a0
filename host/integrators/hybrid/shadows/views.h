// What a light's view shows: frusta fitted to what casts shadows and to what receives them.
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

inline constexpr double kFitPadding = 1e-4; // relative, of what is fitted

// Device world, metres.
struct ShadowFit {
  glm::dvec3 lo{0.0}, hi{0.0};          // box of all that casts shadows
  double radius = 0.0;                  // of the scene
  std::vector<glm::dvec3> receivers;    // corners of a convex body that holds all that the camera sees
  std::uint32_t size = 0;               // texels along a side of a view
  double guard = 0.0;                   // texels around what a view is for, for filters to look at
  double nearest = 0.0, farthest = 0.0; // depths of the camera between which the receivers are
};

// Corners of the part of the box that the camera sees between two depths; empty if there is none. `view` in the world
// moved by -origin.
std::vector<glm::dvec3> seen_corners(const View& view, const glm::dvec3& lo, const glm::dvec3& hi, double nearest,
                                     double farthest);

// A view along parallel rays that shows the receivers, and all that is between them and the light.
gpu::ShadowView parallel_view(const ShadowFit& fit, const glm::dvec3& direction);
// The same as wide as points that are not all of the receivers, but as deep as all of them.
gpu::ShadowView parallel_view(const ShadowFit& fit, const glm::dvec3& direction, std::span<const glm::dvec3> shown);

// A view from a point: `tangent`: of the half angle that it shows; `radius`: of a lamp around it; `first`: depth before
// which nothing casts a shadow, if it is not the least there can be.
gpu::ShadowView perspective_view(const ShadowFit& fit, const glm::dvec3& position, const glm::dvec3& forward,
                                 const glm::dvec3& up, double tangent, double radius = 0.0, double first = 0.0);

// Six views that together show all directions, from a point or from the middle of a sphere, which they do not show.
std::vector<gpu::ShadowView> cube_views(const ShadowFit& fit, const glm::dvec3& position, double radius = 0.0);

// Two that do, as paraboloid mirrors: of what is below the light, where most of what lamps shine on is, and above it.
std::vector<gpu::ShadowView> paraboloid_views(const ShadowFit& fit, const glm::dvec3& position);

// The usual ones: parallel for suns, one in perspective for spots and for rectangles and discs, seen from the middle,
// a cube for points, spheres and wide spots.
std::vector<gpu::ShadowView> usual_views(const ShadowFit& fit, const ShadowSource& source);

// What a box must reach into to be in a view.
std::vector<HalfSpace> frustum_of(const gpu::ShadowView& view);

} // namespace wavepath
