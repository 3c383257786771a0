// The GGX microfacet distribution with height-correlated Smith shadowing, in the local basis (z = shading normal).
//
// Everything is written in the stretched vector (x/alpha, y/alpha, z) or in sines, never 1 - cos^2, so that it stays
// accurate from alpha = 1e-4 to 1 and down to grazing angles.
#ifndef WAVEPATH_MICROFACET_GLSL
#define WAVEPATH_MICROFACET_GLSL

#include "kernels/base/math.glsl"

float ggx_distribution(vec3 h, float alpha) {
  vec3 s = vec3(h.xy / alpha, h.z);
  float d = alpha * dot(s, s);
  return kInvPi / (d * d);
}

// sqrt(z^2 + alpha^2 (x^2 + y^2)): the root that Smith's functions share.
float smith_root(vec3 w, float alpha) { return sqrt(w.z * w.z + alpha * alpha * dot(w.xy, w.xy)); }

// G2(wo, wi) / (4 cos_o cos_i), for directions on one side each; z enters by magnitude.
float smith_visibility(vec3 wo, vec3 wi, float alpha) {
  float o = abs(wo.z), i = abs(wi.z);
  return 0.5 / max(i * smith_root(wo, alpha) + o * smith_root(wi, alpha), 1e-20);
}

// Density of the visible normal h divided by 4 |wo.h|: the density of the direction that is wo mirrored about h.
float ggx_reflected_pdf(vec3 wo, vec3 h, float alpha) {
  return 0.5 * ggx_distribution(h, alpha) / (wo.z + smith_root(wo, alpha));
}

// The same, stretched differently along x and y.
float ggx_distribution(vec3 h, vec2 alpha) {
  vec3 s = vec3(h.xy / alpha, h.z);
  float d = dot(s, s);
  return kInvPi / (alpha.x * alpha.y * d * d);
}

float smith_root(vec3 w, vec2 alpha) {
  vec2 s = alpha * w.xy;
  return sqrt(w.z * w.z + dot(s, s));
}

float smith_visibility(vec3 wo, vec3 wi, vec2 alpha) {
  float o = abs(wo.z), i = abs(wi.z);
  return 0.5 / max(i * smith_root(wo, alpha) + o * smith_root(wi, alpha), 1e-20);
}

float ggx_reflected_pdf(vec3 wo, vec3 h, vec2 alpha) {
  return 0.5 * ggx_distribution(h, alpha) / (wo.z + smith_root(wo, alpha));
}

// A normal visible from wo (wo.z > 0), by spherical caps (Dupuy and Benyoub 2023): in the space where the ellipsoid is
// a sphere, the visible normals are half vectors of wo and a uniform direction of the cap z > -wo.z. The cap is
// parametrized by its height below the pole, which makes sin^2 = s (2 - s) exact and z + wo.z a product, so nothing
// cancels.
vec3 ggx_sample_visible_normal(vec3 wo, vec2 alpha, vec2 u) {
  vec3 o = normalize(vec3(alpha * wo.xy, wo.z));
  float s = u.y * (1.0 + o.z);
  vec2 rim = sqrt(max(s * (2.0 - s), 0.0)) * cos_sin_turns(u.x);
  vec3 h = vec3(rim + o.xy, (1.0 - u.y) * (1.0 + o.z));
  return normalize(vec3(alpha * h.xy, h.z));
}

vec3 ggx_sample_visible_normal(vec3 wo, float alpha, vec2 u) {
  return ggx_sample_visible_normal(wo, vec2(alpha), u);
}

#endif
