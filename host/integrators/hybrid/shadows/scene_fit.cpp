#include "host/integrators/hybrid/shadows/scene_fit.h"

namespace wavepath {
namespace {

constexpr double kNarrowNear = 1e-30;
constexpr double kWidestFilter = 1.5; // pixels: radius of the widest filter of kernels/base/filter.glsl

} // namespace

View with_filter_margin(View view, const RenderPlan& settings) {
  view.right *= 1.0 + 2.0 * kWidestFilter / settings.width;
  view.up *= 1.0 + 2.0 * kWidestFilter / settings.height;
  return view;
}

ShadowFit fit_to_scene(const PackedScene& scene, std::span<const Chunk> chunks, const View& world) {
  View view = world;
  view.position -= scene.origin;
  ShadowFit fit;
  fit.lo = glm::dvec3(1e300), fit.hi = glm::dvec3(-1e300);
  for (const Chunk& chunk : chunks) {
    fit.lo = glm::min(fit.lo, chunk.centre - chunk.half);
    fit.hi = glm::max(fit.hi, chunk.centre + chunk.half);
  }
  fit.radius = scene.radius;
  const double far = glm::distance(view.position, 0.5 * (fit.lo + fit.hi)) + glm::distance(fit.lo, fit.hi);
  fit.nearest = view.orthographic ? 0.0 : kNarrowNear * far;
  fit.farthest = far;
  fit.receivers = seen_corners(view, fit.lo, fit.hi, fit.nearest, fit.farthest);
  if (fit.receivers.empty()) fit.receivers = {fit.lo, fit.hi};
  return fit;
}

} // namespace wavepath
