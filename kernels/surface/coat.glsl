// KHR_materials_clearcoat: a dielectric layer of ior 1.5 with a roughness and a normal of its own above everything
// else.
//
// The lobes below are scaled by the coat's transmittance: the diffuse base by T(o) T(i) / mean T, as its own interface
// does (bsdf.glsl); all other lobes by the smaller of T(o) and T(i). Both factors are reciprocal and return no more
// light than arrives. With the single factor T(o) of glTF's appendix, light paths and camera paths would not agree.
#ifndef WAVEPATH_COAT_GLSL
#define WAVEPATH_COAT_GLSL

#include "kernels/surface/fresnel.glsl"
#include "kernels/base/math.glsl"
#include "kernels/surface/microfacet.glsl"

struct Coat {
  float weight; // clearcoat; 0 = none
  float alpha;
  vec3 normal; // in the local basis of the base
};

Interface coat_interface() { return Interface(vec3(0.04), 1.0, 1.5, 0.04); }

float coat_fresnel(Coat coat, float c) { return coat.weight * fresnel_exact(c, 1.5); }

// Fraction of the light along w that gets past the coat.
float coat_passes(Coat coat, vec3 w) {
  float mu = clamp(abs(dot(coat.normal, w)), 0.0, 1.0);
  return 1.0 - coat.weight * (1.0 - interface_transmittance(coat_interface(), mu, coat.alpha));
}

float coat_passes_mean(Coat coat) { return 1.0 - coat.weight * interface_mean(coat_interface(), coat.alpha); }

// f |cos|, the cosine being that with the coat's own normal.
float eval_coat(Coat coat, vec3 wo, vec3 wi, out float pdf) {
  pdf = 0.0;
  vec3 t, b;
  make_basis(coat.normal, t, b);
  vec3 o = to_local(wo, t, b, coat.normal), i = to_local(wi, t, b, coat.normal);
  if (!(o.z > 0.0) || !(i.z > 0.0)) return 0.0;
  vec3 h = normalize(o + i);
  pdf = ggx_reflected_pdf(o, h, coat.alpha);
  return coat_fresnel(coat, dot(o, h)) * (ggx_distribution(h, coat.alpha) * smith_visibility(o, i, coat.alpha) * i.z);
}

// A direction that it reflects to; false where that lies below its own horizon. Delta: the mirror direction.
bool sample_coat(Coat coat, vec3 wo, vec2 u, bool delta, out vec3 wi) {
  vec3 t, b;
  make_basis(coat.normal, t, b);
  vec3 o = to_local(wo, t, b, coat.normal);
  vec3 h = delta ? vec3(0.0, 0.0, 1.0) : ggx_sample_visible_normal(o, coat.alpha, u);
  vec3 i = 2.0 * dot(o, h) * h - o;
  wi = to_world(i, t, b, coat.normal);
  return o.z > 0.0 && i.z > 0.0;
}

#endif
