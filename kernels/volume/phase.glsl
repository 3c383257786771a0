// The phase function of Henyey and Greenstein (1941, "Diffuse radiation in the galaxy").
#ifndef WAVEPATH_VOLUME_PHASE_GLSL
#define WAVEPATH_VOLUME_PHASE_GLSL

#include "kernels/base/math.glsl"

// A direction about the one that light goes on in.
vec3 sample_phase(float g, vec3 forward, vec2 u) {
  float t = (1.0 - g * g) / (1.0 - g + 2.0 * g * u.x);
  float cosine = abs(g) < 1e-3 ? 1.0 - 2.0 * u.x : clamp((1.0 + g * g - t * t) / (2.0 * g), -1.0, 1.0);
  vec3 tangent, bitangent;
  make_basis(forward, tangent, bitangent);
  float sine = sqrt(max(1.0 - cosine * cosine, 0.0));
  vec2 around = sine * cos_sin_turns(u.y);
  return normalize(tangent * around.x + bitangent * around.y + forward * cosine);
}

// Density per solid angle, for the cosine between the two directions; also the fraction of light that is scattered
// there.
float phase_pdf(float g, float cosine) {
  float d = max(1.0 + g * g - 2.0 * g * cosine, 1e-12);
  return 0.25 * kInvPi * (1.0 - g * g) / (d * sqrt(d));
}

#endif
