// Sight of a camera that moves nearly as fast as light (kFeatureRelativity): directions by aberration, radiance by the
// Doppler and searchlight effects. Weiskopf, Kraus and Ruder, "Searchlight and Doppler Effects in the Visualization of
// Special Relativity", ACM Transactions on Graphics 18(3), 1999.
//
// c is the cosine of the angle a from the direction of motion to where the light comes from, in the scene, a' this
// angle for the camera, v the speed in units of that of light, s = boost_scale = sqrt((1 - v) / (1 + v)):
//
//     aberration:  tan(a'/2) = s tan(a/2),  the same as  c' = (c + v) / (1 + v c)
//     Doppler:     D = frequency for the camera / frequency in the scene = ((1 + c) / s + (1 - c) s) / 2
//
// All terms are positive: nothing cancels near the speed of light. A solid angle shrinks by D^2.
#ifndef WAVEPATH_RELATIVITY_GLSL
#define WAVEPATH_RELATIVITY_GLSL

#include "kernels/base/config.glsl"

// A macro, as has() is: a condition that folds away in kernels of cameras at rest.
#define MOVES_FAST (has_lobe(kFeatureRelativity) && frame.boost_scale > 0.0)

// 1 + c and 1 - c of a direction of unit length.
vec2 boost_factors(vec3 direction) {
  vec3 ahead = direction + frame.boost_axis, behind = direction - frame.boost_axis;
  return 0.5 * vec2(dot(ahead, ahead), dot(behind, behind));
}

// The direction whose half angle from the axis has the tangent times `scale`.
vec3 boosted(vec3 direction, float scale) {
  vec2 factors = boost_factors(direction) * vec2(1.0 / scale, scale);
  vec3 across = direction - dot(direction, frame.boost_axis) * frame.boost_axis;
  return normalize(0.5 * (factors.x - factors.y) * frame.boost_axis + across);
}

// A direction of the scene, as the camera sees it; and back.
vec3 seen_direction(vec3 direction) { return boosted(direction, frame.boost_scale); }
vec3 scene_direction(vec3 seen) { return boosted(seen, 1.0 / frame.boost_scale); }

// D of light that comes from a direction of the scene.
float doppler_factor(vec3 direction) {
  vec2 factors = boost_factors(direction);
  return 0.5 * (factors.x / frame.boost_scale + factors.y * frame.boost_scale);
}

// ---- radiance -------------------------------------------------------------------------------------------------------
// Radiance per wavelength changes as L'(w) = D^5 L(D w). Three channels are no spectrum, so each stands for its
// radiance at one wavelength: linear in between, constant beyond both ends.

const vec3 kPrimaryWavelengths = vec3(611.4, 549.1, 464.2); // nm: dominant ones of the primaries of BT.709

float radiance_at(vec3 radiance, float wavelength) {
  vec3 w = kPrimaryWavelengths;
  if (wavelength >= w.g) return mix(radiance.g, radiance.r, min((wavelength - w.g) / (w.r - w.g), 1.0));
  return mix(radiance.b, radiance.g, max((wavelength - w.b) / (w.g - w.b), 0.0));
}

// Radiance that the camera sees of light with the Doppler factor d.
vec3 doppler_shifted(vec3 radiance, float d) {
  vec3 w = d * kPrimaryWavelengths;
  vec3 shifted = vec3(radiance_at(radiance, w.r), radiance_at(radiance, w.g), radiance_at(radiance, w.b));
  return (d * d) * (d * d) * d * shifted;
}

#endif
