#include "host/integrators/hybrid/shadows/taps.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "kernels/hybrid/shadows/shadow_types.h"

namespace wavepath {
namespace {

std::vector<glm::vec4> grid(std::uint32_t count) {
  auto side = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(count)));
  while ((side + 1) * (side + 1) <= count) ++side;
  std::vector<glm::vec4> taps;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const glm::vec2 at = (glm::vec2(i % side, i / side) + 0.5f) * (2.0f / static_cast<float>(side)) - 1.0f;
    taps.emplace_back(at, 0.0f, 0.0f);
  }
  return taps;
}

// Positions of a sunflower's seeds: equal areas, each turned by the golden angle against the one before (Vogel 1979).
std::vector<glm::vec4> vogel(std::uint32_t count) {
  constexpr double kGoldenAngle = 2.39996322972865332;
  std::vector<glm::vec4> taps;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double radius = std::sqrt((i + 0.5) / count), angle = i * kGoldenAngle;
    taps.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0f, 0.0f);
  }
  return taps;
}

// The best of some candidates, each time the one farthest from those before (Mitchell 1991).
std::vector<glm::vec4> poisson(std::uint32_t count) {
  constexpr std::size_t kCandidates = 16;
  std::mt19937 bits(1); // the same on every machine, unlike distributions
  const auto unit = [&] { return 2.0 * (bits() * 0x1p-32) - 1.0; };
  std::vector<glm::dvec2> chosen;
  while (chosen.size() < count) {
    glm::dvec2 best(0.0);
    double farthest = -1.0;
    for (std::size_t i = 0; i < kCandidates * (1 + chosen.size() / 4);) {
      const glm::dvec2 candidate(unit(), unit());
      if (glm::length(candidate) > 1.0) continue;
      ++i;
      double nearest = 4.0;
      for (const glm::dvec2& p : chosen) nearest = std::min(nearest, glm::distance(p, candidate));
      if (nearest > farthest) {
        farthest = nearest;
        best = candidate;
      }
    }
    chosen.push_back(best);
  }
  std::vector<glm::vec4> taps;
  for (const glm::dvec2& p : chosen) taps.emplace_back(p.x, p.y, 0.0f, 0.0f);
  return taps;
}

} // namespace

std::vector<glm::vec4> filter_taps(std::uint32_t pattern, std::uint32_t count) {
  if (pattern == gpu::kPatternGrid) return grid(count);
  return pattern == gpu::kPatternVogel ? vogel(count) : poisson(count);
}

} // namespace wavepath
