#include "host/integrators/hybrid/shadows/warped_views.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace wavepath {
namespace {

constexpr double kParallel = 1e-3; // sine of the angle between light and camera below which there is nothing to warp
// Depth that counts as the nearest one, of the farthest: a hull reaches to the eye.
constexpr double kNearestDepth = 0.01;
constexpr double kFlattest = 0.01;     // ratio of least and largest w up to which a perspective is taken
constexpr double kFocus = 0.25;        // fraction of the depths that a trapezoid gives most of the map to,
constexpr double kFocusPosition = 0.6; // which ends there, between -1 and 1

struct Range {
  double lo = 1e300, hi = -1e300;
  void add(double x) { lo = std::min(lo, x), hi = std::max(hi, x); }
  double middle() const { return 0.5 * (lo + hi); }
  double extent() const { return hi - lo; }
};

// x / w and y / w are coordinates on the plane at right angles to the light: three rows for points (p, 1).
struct Homography {
  glm::dvec4 x, y, w;
};

template <class F>
Range range_over(const std::vector<glm::dvec3>& points, const F& value) {
  Range range;
  for (const glm::dvec3& p : points) range.add(value(glm::dvec4(p, 1.0)));
  return range;
}

Range depths_of(const ShadowFit& fit, const View& view) {
  const glm::dvec4 depth(view.forward, -glm::dot(view.forward, view.position));
  return range_over(fit.receivers, [&](const glm::dvec4& p) { return glm::dot(depth, p); });
}

// True if x to the right and y downwards mirror the world, which would turn fronts into backs.
bool is_mirrored(const glm::dvec4& x, const glm::dvec4& y, const glm::dvec4& w, const glm::dvec3& p,
                 const glm::dvec3& direction) {
  const glm::dvec4 q(p, 1.0);
  const glm::dvec3 right(x - glm::dot(x, q) / glm::dot(w, q) * w), down(y - glm::dot(y, q) / glm::dot(w, q) * w);
  return glm::dot(glm::cross(right, down), direction) < 0.0;
}

// The parallel view with other rows, moved and scaled so that it shows the receivers.
gpu::ShadowView warped_view(const ShadowFit& fit, const glm::dvec3& direction, const Homography& map) {
  const double largest = range_over(fit.receivers, [&](const glm::dvec4& p) { return glm::dot(map.w, p); }).hi;
  const glm::dvec4 w = map.w / largest;
  const double inside = fit.size / std::max(fit.size - 2.0 * fit.guard, 1.0);
  const auto fitted = [&](const glm::dvec4& row) {
    const Range range =
        range_over(fit.receivers, [&](const glm::dvec4& p) { return glm::dot(row, p) / glm::dot(w, p); });
    return (row - range.middle() * w) / (0.5 * inside * (1.0 + kFitPadding) * range.extent());
  };
  const glm::dvec4 x = fitted(map.x), y = fitted(map.y);
  gpu::ShadowView view = parallel_view(fit, direction);
  view.x = gpu::vec4(x);
  view.y = gpu::vec4(is_mirrored(x, y, w, fit.receivers.front(), direction) ? -y : y);
  view.w = gpu::vec4(w);
  // Falls along every ray of light, because w does not change there; and is below w wherever there is a receiver.
  const double least = range_over(fit.receivers, [&](const glm::dvec4& p) { return glm::dot(w, p); }).lo;
  view.z = gpu::vec4((0.5 * least / view.far) * (glm::dvec4(0.0, 0.0, 0.0, view.far) - glm::dvec4(view.depth)));
  view.texel = 0.0f; // not the same everywhere
  return view;
}

// The camera's axes on the plane at right angles to the light.
struct Ground {
  glm::dvec3 right, along;
  double sine;  // of the angle between light and camera
  Range extent; // of what is seen, along the camera's axis

  Ground(const ShadowFit& fit, const glm::dvec3& direction, const View& view) {
    const glm::dvec3 flat = view.forward - direction * glm::dot(direction, view.forward);
    sine = glm::length(flat);
    along = flat / std::max(sine, kParallel);
    right = glm::cross(direction, along);
    extent = range_over(fit.receivers, [&](const glm::dvec4& p) { return glm::dot(along, glm::dvec3(p)); });
  }

  // Seen from as far before what is seen as `distance`, beside the camera's own eye.
  Homography seen_from(double distance, const View& view) const {
    return {glm::dvec4(right, -glm::dot(right, view.position)), glm::dvec4(-along, extent.lo),
            glm::dvec4(along / distance, 1.0 - extent.lo / distance)};
  }
};

// Points in front of the camera, to the cube that it sees: -1 to 1 across, 0 to 1 in depth. Divided by w.
struct CameraSpace {
  glm::dvec4 x, y, z, w;

  CameraSpace(const View& view, const Range& depths, double step) {
    const glm::dvec3 eye = view.position - step * view.forward;
    const double near = std::max(depths.lo, kNearestDepth * depths.hi) + step, far = depths.hi + step;
    const double narrower = view.orthographic ? 1.0 : depths.hi / far;
    const auto row = [&](const glm::dvec3& axis, double scale) {
      return glm::dvec4(axis, -glm::dot(axis, eye)) * scale;
    };
    x = row(view.right, 1.0 / (narrower * glm::dot(view.right, view.right)));
    y = row(view.up, 1.0 / (narrower * glm::dot(view.up, view.up)));
    const glm::dvec4 depth = row(view.forward, 1.0), one(0.0, 0.0, 0.0, 1.0);
    z = view.orthographic ? (depth - near * one) / (far - near) : far / (far - near) * (depth - near * one);
    w = view.orthographic ? one : depth;
  }
  glm::dvec4 operator()(const glm::dvec4& p) const {
    return {glm::dot(x, p), glm::dot(y, p), glm::dot(z, p), glm::dot(w, p)};
  }
  // The row that is `weights` times what () gives.
  glm::dvec4 row(const glm::dvec4& weights) const {
    return weights.x * x + weights.y * y + weights.z * z + weights.w * w;
  }
};

// The view of that cube's middle from where the light is in camera space: a point, or a direction where the camera
// looks at right angles to the light. All that is said of the light's point is said times its w, which may be 0.
Homography seen_by_light(const CameraSpace& space, const glm::dvec3& direction) {
  const glm::dvec3 middle(0.0, 0.0, 0.5);
  const glm::dvec4 light = space(glm::dvec4(direction, 0.0));
  const glm::dvec3 axis = light.w * middle - glm::dvec3(light), unit = glm::normalize(axis);
  const glm::dvec3 wish = std::abs(unit.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(wish, unit)), v = glm::cross(unit, u);
  const auto from_middle = [&](const glm::dvec3& a) { return space.row(glm::dvec4(a, -glm::dot(a, middle))); };
  const double nearness = light.w / glm::dot(axis, axis);
  return {from_middle(u), from_middle(v), space.w + from_middle(axis * nearness)};
}

} // namespace

gpu::ShadowView light_space_perspective_view(const ShadowFit& fit, const glm::dvec3& direction, const View& view,
                                             std::optional<double> distance) {
  const Ground ground(fit, direction, view);
  if (ground.sine < kParallel || (view.orthographic && !distance)) return parallel_view(fit, direction);
  const double far = depths_of(fit, view).hi, near = std::max(depths_of(fit, view).lo, kNearestDepth * far);
  const double best = (near + std::sqrt(near * (near + ground.extent.extent() * ground.sine))) / ground.sine;
  return warped_view(fit, direction, ground.seen_from(distance ? *distance * ground.extent.extent() : best, view));
}

gpu::ShadowView trapezoidal_view(const ShadowFit& fit, const glm::dvec3& direction, const View& view) {
  const Ground ground(fit, direction, view);
  if (ground.sine < kParallel || view.orthographic) return parallel_view(fit, direction);
  const Range depths = depths_of(fit, view);
  const glm::dvec3 focus = view.position + glm::mix(depths.lo, depths.hi, kFocus) * view.forward;
  const double extent = ground.extent.extent();
  const double until = std::max(glm::dot(ground.along, focus) - ground.extent.lo, kNearestDepth * extent);
  // The perspective that moves the end of the focus to its position.
  const double slack = (1.0 + kFocusPosition) * extent - 2.0 * until;
  if (slack <= 0.0) return parallel_view(fit, direction); // it has as much as that anyway
  return warped_view(fit, direction, ground.seen_from((1.0 - kFocusPosition) * until * extent / slack, view));
}

gpu::ShadowView camera_space_view(const ShadowFit& fit, const glm::dvec3& direction, const View& view) {
  constexpr int kFirstStep = -7, kLastStep = 10; // powers of two, of the farthest depth
  const Range depths = depths_of(fit, view);
  for (int i = kFirstStep - 1; i <= kLastStep; ++i) {
    const double step = i < kFirstStep ? 0.0 : std::ldexp(depths.hi, i);
    const Homography map = seen_by_light(CameraSpace(view, depths, step), direction);
    const Range w = range_over(fit.receivers, [&](const glm::dvec4& p) { return glm::dot(map.w, p); });
    if (w.lo > kFlattest * w.hi) return warped_view(fit, direction, map);
  }
  return parallel_view(fit, direction);
}

} // namespace wavepath
