#include "host/integrators/hybrid/shadows/views.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace wavepath {
namespace {

constexpr double kWidest = 4.0;           // tangent of a half angle; more is shown by cubes, or traced
constexpr double kNear = 1e-4;            // of the scene's radius
constexpr double kClearOfTheLamp = 1.001; // near end of views from within a sphere, in its radii

gpu::vec4 row(const glm::dvec3& v, double offset) { return glm::vec4(glm::dvec4(v, offset)); }

// A direction at right angles to `v`, near to `wish` if that is not parallel to it.
glm::dvec3 across(const glm::dvec3& v, const glm::dvec3& wish) {
  glm::dvec3 up = wish - v * glm::dot(wish, v);
  if (glm::length(up) < 1e-3) {
    const glm::dvec3 other = std::abs(v.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
    up = other - v * glm::dot(other, v);
  }
  return glm::normalize(up);
}

std::array<glm::dvec3, 8> corners_of(const glm::dvec3& lo, const glm::dvec3& hi) {
  std::array<glm::dvec3, 8> corners;
  for (int i = 0; i < 8; ++i) corners[i] = {i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z};
  return corners;
}

// Inside where dot(normal, p) + offset >= 0.
using Plane = glm::dvec4;
bool is_inside(const Plane& plane, const glm::dvec3& p, double slack) {
  return glm::dot(glm::dvec3(plane), p) + plane.w >= -slack * glm::length(glm::dvec3(plane));
}

// Where the edges of a hexahedron, corners numbered as by corners_of(), meet planes.
void add_crossings(const std::array<glm::dvec3, 8>& body, const std::vector<Plane>& planes,
                   std::vector<glm::dvec3>& points) {
  for (int i = 0; i < 8; ++i)
    for (const int bit : {1, 2, 4}) {
      if (i & bit) continue;
      const glm::dvec3 &a = body[i], &b = body[i | bit];
      for (const Plane& plane : planes) {
        const double at_a = glm::dot(glm::dvec3(plane), a) + plane.w, at_b = glm::dot(glm::dvec3(plane), b) + plane.w;
        if ((at_a < 0.0) != (at_b < 0.0)) points.push_back(glm::mix(a, b, at_a / (at_a - at_b)));
      }
    }
}

} // namespace

std::vector<glm::dvec3> seen_corners(const View& view, const glm::dvec3& lo, const glm::dvec3& hi, double nearest,
                                     double farthest) {
  std::array<glm::dvec3, 8> frustum;
  for (int i = 0; i < 8; ++i) {
    const double depth = i & 4 ? farthest : nearest, scale = view.orthographic ? 1.0 : depth;
    frustum[i] = view.position + depth * view.forward +
                 scale * ((i & 1 ? 1.0 : -1.0) * view.right + (i & 2 ? 1.0 : -1.0) * view.up);
  }
  const auto side = [&](const glm::dvec3& extent, double sign) {
    const glm::dvec3 unit = extent / glm::dot(extent, extent);
    const glm::dvec3 normal = sign * unit + (view.orthographic ? glm::dvec3(0.0) : view.forward);
    return Plane(normal, (view.orthographic ? 1.0 : 0.0) - glm::dot(normal, view.position));
  };
  const double at = glm::dot(view.forward, view.position);
  const std::vector<Plane> sides = {side(view.right, 1.0),
                                    side(view.right, -1.0),
                                    side(view.up, 1.0),
                                    side(view.up, -1.0),
                                    Plane(view.forward, -at - nearest),
                                    Plane(-view.forward, at + farthest)};
  const std::vector<Plane> box = {Plane(1, 0, 0, -lo.x), Plane(-1, 0, 0, hi.x), Plane(0, 1, 0, -lo.y),
                                  Plane(0, -1, 0, hi.y), Plane(0, 0, 1, -lo.z), Plane(0, 0, -1, hi.z)};
  const std::array<glm::dvec3, 8> corners = corners_of(lo, hi);
  std::vector<glm::dvec3> points(frustum.begin(), frustum.end());
  points.insert(points.end(), corners.begin(), corners.end());
  add_crossings(frustum, box, points);
  add_crossings(corners, sides, points);
  const double slack = 1e-9 * (glm::distance(lo, hi) + farthest);
  std::erase_if(points, [&](const glm::dvec3& p) {
    const auto outside = [&](const Plane& plane) { return !is_inside(plane, p, slack); };
    return std::ranges::any_of(sides, outside) || std::ranges::any_of(box, outside);
  });
  return points;
}

gpu::ShadowView parallel_view(const ShadowFit& fit, const glm::dvec3& direction) {
  return parallel_view(fit, direction, fit.receivers);
}

gpu::ShadowView parallel_view(const ShadowFit& fit, const glm::dvec3& direction, std::span<const glm::dvec3> shown) {
  const glm::dvec3 up = across(direction, glm::dvec3(0, 1, 0)), right = glm::cross(direction, up);
  glm::dvec3 lo(1e300), hi(-1e300);
  for (const glm::dvec3& p : shown) {
    const glm::dvec3 at(glm::dot(right, p), glm::dot(up, p), glm::dot(direction, p));
    lo = glm::min(lo, at);
    hi = glm::max(hi, at);
  }
  for (const glm::dvec3& p : fit.receivers) hi.z = std::max(hi.z, glm::dot(direction, p));
  for (const glm::dvec3& p : corners_of(fit.lo, fit.hi)) lo.z = std::min(lo.z, glm::dot(direction, p));
  const double margin = kFitPadding * fit.radius;
  const double inside = fit.size / std::max(fit.size - 2.0 * fit.guard, 1.0);
  const glm::dvec2 half = inside * (0.5 * (glm::dvec2(hi) - glm::dvec2(lo)) + margin);
  const glm::dvec2 middle = 0.5 * (glm::dvec2(hi) + glm::dvec2(lo));
  const double first = lo.z - margin, far = hi.z + margin - first;
  gpu::ShadowView view{};
  view.x = row(right / half.x, -middle.x / half.x);
  view.y = row(-up / half.y, middle.y / half.y);
  view.z = row(-direction / far, 1.0 + first / far);
  view.w = row(glm::dvec3(0.0), 1.0);
  view.depth = row(direction, -first);
  view.light = glm::vec3(-direction);
  view.kind = gpu::kViewParallel;
  view.texel = static_cast<float>(2.0 * std::max(half.x, half.y) / fit.size);
  view.far = static_cast<float>(far);
  return view;
}

gpu::ShadowView perspective_view(const ShadowFit& fit, const glm::dvec3& position, const glm::dvec3& forward,
                                 const glm::dvec3& up, double tangent, double radius, double first) {
  const glm::dvec3 right = glm::cross(forward, up);
  double far = 0.0;
  for (const glm::dvec3& p : corners_of(fit.lo, fit.hi)) far = std::max(far, glm::dot(forward, p - position));
  const double reach = tangent * fit.size / std::max(fit.size - 2.0 * fit.guard, 1.0);
  const double near = std::max(kNear * fit.radius, first);
  gpu::ShadowView view{};
  view.x = row(right / reach, -glm::dot(right, position) / reach);
  view.y = row(-up / reach, glm::dot(up, position) / reach);
  view.z = row(glm::dvec3(0.0), near); // near / depth keeps its relative precision
  view.w = row(forward, -glm::dot(forward, position));
  view.depth = view.w;
  view.light = glm::vec3(position);
  view.kind = gpu::kViewPerspective;
  view.texel = static_cast<float>(2.0 * reach / fit.size);
  view.near = static_cast<float>(near);
  view.far = static_cast<float>(std::max(far, 2.0 * near));
  view.radius = static_cast<float>(radius);
  return view;
}

std::vector<gpu::ShadowView> cube_views(const ShadowFit& fit, const glm::dvec3& position, double radius) {
  std::vector<gpu::ShadowView> views;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      glm::dvec3 forward(0.0), up(0.0);
      forward[axis] = sign;
      up[(axis + 1) % 3] = 1.0;
      views.push_back(perspective_view(fit, position, forward, up, 1.0, radius, kClearOfTheLamp * radius));
    }
  return views;
}

std::vector<gpu::ShadowView> paraboloid_views(const ShadowFit& fit, const glm::dvec3& position) {
  double far = 0.0;
  for (const glm::dvec3& p : corners_of(fit.lo, fit.hi)) far = std::max(far, glm::distance(p, position));
  const double near = kNear * fit.radius;
  std::vector<gpu::ShadowView> views;
  for (const double sign : {-1.0, 1.0}) {
    const glm::dvec3 forward(0.0, sign, 0.0), right(1.0, 0.0, 0.0), down = glm::cross(forward, right);
    gpu::ShadowView view{};
    view.x = row(right, -glm::dot(right, position));
    view.y = row(down, -glm::dot(down, position));
    view.w = row(glm::dvec3(0.0), 1.0);
    view.depth = row(forward, -glm::dot(forward, position));
    view.light = glm::vec3(position);
    view.kind = gpu::kViewParaboloid;
    view.texel = static_cast<float>(4.0 / fit.size); // in the middle, where texels are widest
    view.near = static_cast<float>(near);
    view.far = static_cast<float>(std::max(far, 2.0 * near));
    views.push_back(view);
  }
  return views;
}

std::vector<gpu::ShadowView> usual_views(const ShadowFit& fit, const ShadowSource& source) {
  if (source.kind == kDirectionalSource) return {parallel_view(fit, source.direction)};
  if (source.kind == kSphereSource) return cube_views(fit, source.position, glm::length(source.u));
  const glm::dvec3 up = across(source.direction, glm::dvec3(0, 1, 0));
  if (source.kind & kAreaSources) {
    // The view is as wide as the visible receivers; other points are traced.
    const glm::dvec3 right = glm::cross(source.direction, up);
    double tangent = 1e-3;
    for (const glm::dvec3& p : fit.receivers) {
      const glm::dvec3 at = p - source.position;
      const double depth = glm::dot(source.direction, at);
      const double off = std::max(std::abs(glm::dot(right, at)), std::abs(glm::dot(up, at)));
      tangent = std::max(tangent, depth > 0.0 ? off / depth : kWidest);
    }
    // A disc's radius; of a rectangle that of the disc of the same area.
    const double radius = source.kind == kDiscSource
                              ? glm::length(source.u)
                              : 2.0 * std::sqrt(glm::length(source.u) * glm::length(source.v) / 3.14159265358979);
    return {perspective_view(fit, source.position, source.direction, up, std::min(1.001 * tangent, kWidest), radius)};
  }
  if (source.kind == kSpotSource && std::tan(source.half_angle) < kWidest && source.half_angle < 1.5)
    return {perspective_view(fit, source.position, source.direction, up, std::max(std::tan(source.half_angle), 1e-3))};
  return cube_views(fit, source.position);
}

std::vector<HalfSpace> frustum_of(const gpu::ShadowView& view) {
  const glm::dvec4 front(view.depth);
  // Its edges are bent; texels at the rim reach behind the light, see is_behind() in shadow_fragment.glsl.
  if (view.kind == gpu::kViewParaboloid)
    return {HalfSpace{glm::dvec3(front), front.w + double{view.texel} * double{view.far}}};
  const auto side = [&](const gpu::vec4& row, double sign) {
    const glm::dvec4 plane = glm::dvec4(view.w) + sign * glm::dvec4(row);
    return HalfSpace{glm::dvec3(plane), plane.w};
  };
  return {side(view.x, 1.0), side(view.x, -1.0), side(view.y, 1.0), side(view.y, -1.0),
          HalfSpace{glm::dvec3(front), front.w}};
}

} // namespace wavepath
