#include "host/convert/materials.h"

#include <algorithm>
#include <cmath>

#include "host/convert/spectrum.h"
#include "host/convert/textures.h"

namespace wavepath::convert {
namespace {

constexpr double kQuarterTurn = 1.5707963267948966;

double largest(const glm::dvec3& v) { return std::max({v.x, v.y, v.z}); }

} // namespace

void set_roughness(Description& scene, Material& material, const Texture& alpha_u, const Texture& alpha_v) {
  const auto of_gltf = [](const glm::dvec3& alpha) { return glm::sqrt(glm::clamp(alpha, 0.0, 1.0)); };
  if (alpha_u == alpha_v || !alpha_u.is_constant() || !alpha_v.is_constant()) {
    if (!(alpha_u == alpha_v))
      scene.losses.add("textured roughness along the tangent: that across it is taken for both");
    material.roughness = mapped(scene, alpha_v, Holds::numbers, of_gltf);
    return;
  }
  // KHR_materials_anisotropy: along the direction alpha rises towards 1 with the square of the strength.
  const double u = std::clamp(alpha_u.factor.x, 0.0, 1.0), v = std::clamp(alpha_v.factor.x, 0.0, 1.0);
  const double low = std::min(u, v), high = std::max(u, v);
  material.roughness = constant(std::sqrt(low));
  material.anisotropy = low < 1.0 ? std::sqrt((high - low) / (1.0 - low)) : 0.0;
  material.anisotropy_rotation = u < v ? kQuarterTurn : 0.0;
}

Material diffuse(const Texture& reflectance) {
  Material material;
  material.base = reflectance;
  return material;
}

Material conductor(const Texture& reflectance) {
  Material material;
  material.base = reflectance;
  material.metallic = constant(1.0);
  material.roughness = constant(0.0);
  material.specular = 1.0;
  return material;
}

Material dielectric(double ior, bool thin) {
  Material material;
  material.ior = std::max(ior, 1.0);
  material.specular = 1.0;
  material.transmission = 1.0;
  material.volume = !thin;
  material.roughness = constant(0.0);
  return material;
}

Material coated_diffuse(Description& scene, const Texture& reflectance, double ior) {
  Material material;
  material.specular = 1.0;
  material.ior = std::max(ior, 1.0);
  material.roughness = constant(0.0);
  const double inside = internal_diffuse_reflectance(ior);
  material.base = mapped(scene, reflectance, Holds::colors, [&](const glm::dvec3& color) {
    const glm::dvec3 rho = glm::clamp(color, 0.0, 1.0);
    return rho * (1.0 - inside) / (1.0 - rho * inside);
  });
  return material;
}

Material diffuse_transmission(const glm::dvec3& reflectance, const glm::dvec3& transmittance) {
  Material material;
  const double r = largest(reflectance), t = largest(transmittance);
  const double fraction = r + t > 0.0 ? t / (r + t) : 0.0;
  material.base = constant(fraction < 1.0 ? glm::min(reflectance / (1.0 - fraction), 1.0) : glm::dvec3(0.0));
  material.diffuse_transmission = fraction;
  material.diffuse_transmission_color = fraction > 0.0 ? glm::min(transmittance / fraction, 1.0) : glm::dvec3(0.0);
  return material;
}

Material blended(Description& scene, const Material& a, const Material& b, const Texture& amount) {
  // A surface that is partly nothing is one with alpha.
  if (a.is_boundary != b.is_boundary) {
    Material material = a.is_boundary ? b : a;
    const Texture visible =
        a.is_boundary ? amount : mapped(scene, amount, Holds::numbers, [](const glm::dvec3& x) { return 1.0 - x; });
    material.alpha = product(scene, material.alpha, visible, Holds::numbers);
    return material;
  }
  scene.losses.add("mixture of two materials: one with values in between instead");
  const double t = std::clamp(mean(scene, amount).x, 0.0, 1.0);
  const auto number = [&](double x, double y) { return x + (y - x) * t; };
  Material material = t < 0.5 ? a : b;
  material.base = mixed(scene, a.base, b.base, amount, Holds::colors);
  material.alpha = mixed(scene, a.alpha, b.alpha, amount, Holds::numbers);
  material.roughness = mixed(scene, a.roughness, b.roughness, amount, Holds::numbers);
  material.metallic = mixed(scene, a.metallic, b.metallic, amount, Holds::numbers);
  material.specular = number(a.specular, b.specular);
  // That of a material without a specular layer says nothing.
  material.ior = a.specular == 0.0 ? b.ior : b.specular == 0.0 ? a.ior : number(a.ior, b.ior);
  material.transmission = number(a.transmission, b.transmission);
  material.coat = number(a.coat, b.coat);
  material.diffuse_transmission = number(a.diffuse_transmission, b.diffuse_transmission);
  return material;
}

} // namespace wavepath::convert
