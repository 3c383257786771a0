#include "host/integrators/hybrid/shadows/cascade_views.h"

#include <algorithm>
#include <cmath>

namespace wavepath {
namespace {

constexpr double kLogarithmic = 0.5;   // weight of parts of equal ratio
constexpr double kNearestSplit = 1e-3; // of the farthest depth

} // namespace

std::vector<double> split_depths(double nearest, double farthest, std::uint32_t parts) {
  const double first = std::max(nearest, kNearestSplit * farthest);
  std::vector<double> depths = {nearest};
  for (std::uint32_t i = 1; i < parts; ++i) {
    const double fraction = static_cast<double>(i) / parts;
    depths.push_back(
        glm::mix(glm::mix(first, farthest, fraction), first * std::pow(farthest / first, fraction), kLogarithmic));
  }
  depths.push_back(farthest);
  return depths;
}

std::vector<gpu::ShadowView> cascade_views(const ShadowFit& fit, const glm::dvec3& direction, const View& view,
                                           std::uint32_t parts) {
  double nearest = fit.farthest, farthest = fit.nearest;
  for (const glm::dvec3& p : fit.receivers) {
    const double depth = glm::dot(view.forward, p - view.position);
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
  }
  std::vector<double> depths = split_depths(std::max(nearest, fit.nearest), farthest, parts);
  depths.front() = fit.nearest; // what rounding leaves out at either end is in a view all the same
  depths.back() = fit.farthest;
  std::vector<gpu::ShadowView> views;
  for (std::uint32_t i = 0; i < parts; ++i) {
    const std::vector<glm::dvec3> shown = seen_corners(view, fit.lo, fit.hi, depths[i], depths[i + 1]);
    if (!shown.empty()) views.push_back(parallel_view(fit, direction, shown));
  }
  if (views.empty()) views.push_back(parallel_view(fit, direction));
  return views;
}

gpu::ShadowView cropped_view(const gpu::ShadowView& view, const glm::dvec2& lo, const glm::dvec2& hi,
                             std::uint32_t size) {
  const double inside = size / (size - 2.0); // a texel around, as in views that are not cropped
  const glm::dvec2 middle = 0.5 * (lo + hi), half = 0.5 * inside * (hi - lo);
  const auto crop = [&](const gpu::vec4& row, double at, double reach) {
    return gpu::vec4((glm::dvec4(row) - at * glm::dvec4(view.w)) / reach);
  };
  gpu::ShadowView cropped = view;
  cropped.x = crop(view.x, middle.x, half.x);
  cropped.y = crop(view.y, middle.y, half.y);
  cropped.texel = 2.0f / (static_cast<float>(size) *
                          std::min(glm::length(glm::vec3(cropped.x)), glm::length(glm::vec3(cropped.y))));
  return cropped;
}

gpu::ShadowView blind_view(const gpu::ShadowView& view) {
  gpu::ShadowView blind = view;
  blind.w = gpu::vec4(0.0f, 0.0f, 0.0f, -1.0f);
  return blind;
}

} // namespace wavepath
