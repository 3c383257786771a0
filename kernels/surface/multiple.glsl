// Light that scatters more than once between the microfacets of a rough surface, which the single bounce of bsdf.glsl
// loses: up to 69 % at roughness 1.
//
// After Kulla and Conty Estevez ("Revisiting Physically Based Shading at Imageworks", 2017). The lobe is proportional
// to D(o) D(i), where D = 1 - directional albedo of the single bounce without absorption. It returns exactly the
// missing energy and is reciprocal. A body's lobe is split between the two sides s. The part that passes, t(s), obeys
// t(1) A(1) n(1)^2 = t(2) A(2) n(2)^2, where A is the mean of D, so that light and camera paths agree. The larger t is
// the average transmittance of a smooth interface.
#ifndef WAVEPATH_MULTIPLE_GLSL
#define WAVEPATH_MULTIPLE_GLSL

#include "kernels/surface/albedo_table.glsl"
#include "kernels/base/math.glsl"

const float kLeastMissing = 1e-4; // mean below which there is nothing to return

// Missing energy of GGX microfacets that reflect all light: of one direction, and on average.
float facets_lack(uint table, vec3 w, float alpha) { return 1.0 - table_albedo(table, abs(w.z), sqrt(alpha)); }

// Mean of Schlick's curve over the hemisphere, weighed by the cosine.
vec3 mean_schlick(vec3 f0) { return f0 + (vec3(1.0) - f0) / 21.0; }

// Fraction of the light lacking that metal returns: geometric series of bounces, each absorbing 1 - mean F.
vec3 metal_returns(vec3 f0, float missing) {
  vec3 mean = mean_schlick(f0);
  return mean * mean * (1.0 - missing) / (1.0 - mean * missing);
}

// Fractions of the light lacking on a side of a body that pass to the other. `average`: of the table of the side.
float body_passes(vec4 average, float own_ior, float other_ior) {
  float own = average.x * own_ior * own_ior, other = average.y * other_ior * other_ior;
  return average.z * min(own, other) / max(own, 1e-20);
}

#endif
