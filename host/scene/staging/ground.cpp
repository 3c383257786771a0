// A disc of triangles whose vertex colours fade; see ground.h.
#include "host/scene/staging/ground.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/scene/staging/environment.h"
#include "host/scene/staging/framing.h"

namespace wavepath {
namespace {

using std::numbers::pi;
constexpr std::uint32_t kSectors = 96;
constexpr std::uint32_t kRings = 24; // of the part that fades
constexpr double kOpaque = 1.0;      // radii of the asset's footprint that are opaque,
constexpr double kFaded = 3.5;       // and at which nothing is left of the disc
constexpr double kSunk = 1e-4;       // of the asset's radius: clear of surfaces that lie at the lowest point
constexpr double kBrightest = 0.9;   // albedo

// Mean radiance where the framing camera sees the floor's far parts: 3 to 30 degrees below the horizon, 30 to either
// side.
glm::dvec3 radiance_behind(const Environment& environment) {
  const glm::dvec3 scale(environment.radiance);
  if (environment.map.empty()) return scale;
  constexpr int kSteps = 64; // each way
  const glm::dvec3 forward = framing_forward();
  const double ahead = std::atan2(forward.z, forward.x);
  glm::dvec3 sum(0.0);
  double weight = 0.0;
  for (int i = 0; i < kSteps * kSteps; ++i) {
    const double azimuth = ahead + glm::radians(-30.0 + 60.0 * (i % kSteps + 0.5) / kSteps),
                 depression = glm::radians(3.0 + 27.0 * (i / kSteps + 0.5) / kSteps);
    const glm::dvec3 d(std::cos(azimuth) * std::cos(depression), -std::sin(depression),
                       std::sin(azimuth) * std::cos(depression));
    const glm::dvec2 uv = environment_uv(d, environment.rotation);
    const auto x = std::min(static_cast<std::uint32_t>(uv.x * environment.width), environment.width - 1),
               y = std::min(static_cast<std::uint32_t>(uv.y * environment.height), environment.height - 1);
    sum += std::cos(depression) * glm::dvec3(environment.map[std::size_t{y} * environment.width + x]);
    weight += std::cos(depression);
  }
  return scale * sum / weight;
}

// Without an environment, in the dark around lamps: a grey of 0.2.
glm::vec3 albedo_under(const Environment& environment) {
  const glm::dvec3 irradiance = floor_irradiance(environment), behind = radiance_behind(environment);
  glm::vec3 albedo;
  for (int c = 0; c < 3; ++c)
    albedo[c] = irradiance[c] > 0.0 ? static_cast<float>(std::min(pi * behind[c] / irradiance[c], kBrightest)) : 0.2f;
  return albedo;
}

// A fan of sectors, then rings; the alpha of each ring falls as a cosine from 1 to 0.
Mesh make_disc(double radius, std::uint32_t material) {
  Mesh disc;
  disc.name = "ground";
  disc.positions.push_back(glm::vec3(0.0f));
  disc.colors.push_back(glm::vec4(1.0f));
  for (std::uint32_t ring = 0; ring <= kRings; ++ring) {
    const double t = static_cast<double>(ring) / kRings;
    const double r = radius * (kOpaque + (kFaded - kOpaque) * t);
    for (std::uint32_t sector = 0; sector < kSectors; ++sector) {
      const double angle = 2.0 * pi * sector / kSectors;
      disc.positions.push_back(
          glm::vec3(r * std::cos(angle), 0.0, -r * std::sin(angle))); // counter-clockwise from above
      disc.colors.push_back(
          {1.0f, 1.0f, 1.0f, ring == kRings ? 0.0f : static_cast<float>(0.5 + 0.5 * std::cos(pi * t))});
    }
  }
  const auto vertex = [](std::uint32_t ring, std::uint32_t sector) { return 1 + ring * kSectors + sector % kSectors; };
  for (std::uint32_t sector = 0; sector < kSectors; ++sector) {
    for (const std::uint32_t v : {0u, vertex(0, sector), vertex(0, sector + 1)}) disc.indices.push_back(v);
    for (std::uint32_t ring = 0; ring < kRings; ++ring) {
      const std::uint32_t a = vertex(ring, sector), b = vertex(ring + 1, sector), c = vertex(ring + 1, sector + 1),
                          d = vertex(ring, sector + 1);
      for (const std::uint32_t v : {a, b, c, a, c, d}) disc.indices.push_back(v);
    }
  }
  disc.primitives.push_back({0, static_cast<std::uint32_t>(disc.indices.size()), material, false});
  return disc;
}

} // namespace

void add_ground(Scene& scene, const Bounds& bounds) {
  if (bounds.empty()) return;
  Material material;
  material.name = "ground";
  material.metallic = 0.0f;
  material.specular = 0.0f; // Lambert
  material.alpha_mode = AlphaMode::blend;
  material.double_sided = true;
  scene.materials.push_back(material);
  relight_ground(scene);

  const double radius = bounds.radius() > 0.0 ? bounds.radius() : 1.0;
  scene.meshes.push_back(make_disc(radius, static_cast<std::uint32_t>(scene.materials.size() - 1)));
  Instance instance;
  instance.mesh = static_cast<std::uint32_t>(scene.meshes.size() - 1);
  const glm::dvec3 centre = bounds.centre();
  instance.world_from_object[3] = glm::dvec4(centre.x, bounds.lo.y - kSunk * radius, centre.z, 1.0);
  scene.instances.push_back(instance);
}

void relight_ground(Scene& scene) {
  scene.materials.back().base_color = glm::vec4(albedo_under(scene.environment), 1.0f);
}

} // namespace wavepath
