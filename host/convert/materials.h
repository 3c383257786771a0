// Materials that both formats have, as those of glTF.
#pragma once

#include "host/convert/described.h"

namespace wavepath::convert {

// Roughness of glTF for alphas of microfacets along the tangent and across.
void set_roughness(Description& scene, Material& material, const Texture& alpha_u, const Texture& alpha_v);
Material diffuse(const Texture& reflectance);
Material conductor(const Texture& reflectance);
Material dielectric(double ior, bool thin);
// A diffuse base under a smooth dielectric. `reflectance`: what the base reflects of the light that reaches it, each
// time the surface sends it back. glTF's base colour is what leaves at last of the light that entered.
Material coated_diffuse(Description& scene, const Texture& reflectance, double ior);
Material diffuse_transmission(const glm::dvec3& reflectance, const glm::dvec3& transmittance);
// Numbers and colours between those of two materials: glTF has no mixture. Tells it.
Material blended(Description& scene, const Material& a, const Material& b, const Texture& amount);

} // namespace wavepath::convert
