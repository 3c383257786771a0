#include "host/integrators/radiosity/refinement.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernels/radiosity/radiosity_types.h"

namespace wavepath {
namespace {

constexpr double kMostRaysOfShot = 1u << 24;
constexpr double kMostWork = 64.0;            // times the first rays: surfaces that reflect all would go on for ever
constexpr double kLeastAbsorbed = 1.0 / 64.0; // of light that the ambient term stands for, on average

} // namespace

double absorbed_power(const std::vector<Face>& faces, const std::vector<glm::dvec3>& irradiance) {
  double sum = 0.0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const glm::dvec3 power = faces[i].area * (1.0 - faces[i].reflectance) * irradiance[i];
    sum += power.r + power.g + power.b;
  }
  return sum;
}

Refinement::Refinement(std::vector<Face> faces, double rays, bool reflects)
    : faces_(std::move(faces)), reflects_(reflects) {
  first_power_ = unshot_power();
  power_of_ray_ = first_power_ / rays;
  most_rays_ = static_cast<std::uint64_t>(kMostWork * rays);
}

double Refinement::unshot_power() const {
  double sum = 0.0;
  for (const Face& face : faces_) sum += face.unshot_power();
  return sum;
}

std::vector<Shot> Refinement::next_shots(std::uint64_t rays) {
  if (!(first_power_ > 0.0) || remaining() <= kRemaining || rays_ >= most_rays_) return {};
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < faces_.size(); ++i)
    if (faces_[i].unshot_power() > 0.0) order.push_back(i);
  const auto precedes = [&](std::uint32_t a, std::uint32_t b) {
    const double power_a = faces_[a].unshot_power(), power_b = faces_[b].unshot_power();
    return power_a != power_b ? power_a > power_b : a < b;
  };
  const std::size_t most = std::min<std::size_t>(order.size(), rays / gpu::kBlockRays + 1);
  std::ranges::partial_sort(order, order.begin() + static_cast<std::ptrdiff_t>(most), precedes);
  std::vector<Shot> shots;
  std::uint64_t taken = 0;
  for (std::size_t i = 0; i < most && (taken < rays || shots.empty()); ++i) {
    Face& face = faces_[order[i]];
    const double wanted = std::clamp(face.unshot_power() / power_of_ray_, 1.0, kMostRaysOfShot);
    const auto blocks = static_cast<std::uint32_t>(std::ceil(wanted / gpu::kBlockRays));
    shots.push_back({order[i], blocks * gpu::kBlockRays, shots_++, face.area * face.unshot});
    taken += shots.back().rays;
    face.unshot = glm::dvec3(0.0);
  }
  rays_ += taken;
  return shots;
}

void Refinement::receive(std::uint32_t index, const glm::dvec3& power) {
  Face& face = faces_[index];
  if (!(face.area > 0.0)) return lose(power);
  const glm::dvec3 irradiance = power / face.area;
  face.irradiance += irradiance;
  if (reflects_) face.unshot += face.reflectance * irradiance;
}

double Refinement::absorbed(const std::vector<glm::dvec3>& irradiance) const {
  return first_power_ > 0.0 ? absorbed_power(faces_, irradiance) / first_power_ : 0.0;
}

// Only faces that light has reached take part: the backs of walls never do.
std::vector<glm::dvec3> Refinement::irradiance() const {
  double area = 0.0;
  glm::dvec3 unshot(0.0), reflectance(0.0);
  for (const Face& face : faces_) {
    if (face.irradiance == glm::dvec3(0.0)) continue;
    area += face.area;
    reflectance += face.area * face.reflectance;
  }
  for (const Face& face : faces_) unshot += face.area * face.unshot;
  glm::dvec3 ambient(0.0);
  if (area > 0.0) ambient = unshot / area / glm::max(1.0 - reflectance / area, glm::dvec3(kLeastAbsorbed));
  std::vector<glm::dvec3> result;
  result.reserve(faces_.size());
  for (const Face& face : faces_)
    result.push_back(face.irradiance == glm::dvec3(0.0) ? glm::dvec3(0.0) : face.irradiance + ambient);
  return result;
}

} // namespace wavepath
