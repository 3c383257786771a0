// Materials, bodies and cameras of cases; see props.h.
#include "host/selftest/props.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace wavepath {

std::uint32_t add_material(Scene& scene, const Material& material) {
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

std::uint32_t add_emitter(Scene& scene, float radiance) {
  Material material;
  material.base_color = glm::vec4(0.0f, 0.0f, 0.0f, 1.0f);
  material.metallic = material.specular = 0.0f;
  material.emission = glm::vec3(radiance);
  return add_material(scene, material);
}

std::uint32_t add_metal(Scene& scene, float roughness) {
  Material material;
  material.roughness = roughness;
  material.double_sided = true;
  return add_material(scene, material);
}

std::uint32_t add_glass(Scene& scene, float ior, float roughness) {
  Material material;
  material.metallic = 0.0f;
  material.roughness = roughness;
  material.transmission = 1.0f;
  material.volume = true;
  material.ior = ior;
  material.double_sided = true;
  return add_material(scene, material);
}

Triangles quad(glm::vec3 corner, glm::vec3 a, glm::vec3 b) {
  return {corner, corner + a, corner + a + b, corner, corner + a + b, corner + b};
}

Triangles floor_quad(float half) { return quad({-half, 0, half}, {2 * half, 0, 0}, {0, 0, -2 * half}); }

Triangles box(glm::vec3 lo, glm::vec3 hi) {
  const glm::vec3 x(hi.x - lo.x, 0, 0), y(0, hi.y - lo.y, 0), z(0, 0, hi.z - lo.z);
  Triangles all;
  for (const Triangles& side :
       {quad(lo, y, x), quad(lo, z, y), quad(lo, x, z), quad(hi, -x, -y), quad(hi, -y, -z), quad(hi, -z, -x)})
    all.insert(all.end(), side.begin(), side.end());
  return all;
}

Triangles disc(glm::vec3 centre, float radius, int sides) {
  const auto rim = [&](int i) {
    const double angle = 2.0 * std::numbers::pi * (i % sides) / sides;
    return centre + radius * glm::vec3(glm::dvec3(std::cos(angle), 0.0, std::sin(angle)));
  };
  Triangles all;
  for (int i = 0; i < sides; ++i) all.insert(all.end(), {centre, rim(i), rim(i + 1)});
  return all;
}

Triangles ball(glm::dvec3 centre, double radius, int rings) {
  const int around = 2 * rings;
  const auto at = [&](int ring, int i) {
    const double polar = std::numbers::pi * ring / rings, angle = 2.0 * std::numbers::pi * (i % around) / around;
    const double r = ring == 0 || ring == rings ? 0.0 : std::sin(polar);
    return glm::vec3(centre + radius * glm::dvec3(r * std::cos(angle), std::cos(polar), r * std::sin(angle)));
  };
  Triangles all;
  for (int ring = 0; ring < rings; ++ring)
    for (int i = 0; i < around; ++i) {
      const glm::vec3 a = at(ring, i), b = at(ring, i + 1), c = at(ring + 1, i), d = at(ring + 1, i + 1);
      if (ring > 0) all.insert(all.end(), {a, b, d});
      if (ring + 1 < rings) all.insert(all.end(), {a, d, c});
    }
  return all;
}

Triangles flipped(Triangles triangles) {
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) std::swap(triangles[i + 1], triangles[i + 2]);
  return triangles;
}

void look_down(Scene& scene, double extent, double distance, double cosine, glm::dvec3 target) {
  const double sine = std::sqrt((1.0 - cosine) * (1.0 + cosine));
  Camera camera;
  camera.orthographic = true;
  camera.xmag = camera.ymag = extent;
  const glm::dvec3 back(0.0, cosine, sine), up(0.0, sine, -cosine);
  camera.world_from_camera = {glm::dvec4(1.0, 0.0, 0.0, 0.0), glm::dvec4(up, 0.0), glm::dvec4(back, 0.0),
                              glm::dvec4(target + distance * back, 1.0)};
  scene.cameras.push_back(camera);
}

} // namespace wavepath
