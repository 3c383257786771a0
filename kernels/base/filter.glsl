// Pixel filters by importance sampling: a position drawn in proportion to the filter, with weight 1.
//
// box: 1 pixel wide. gaussian: sigma 0.5 pixels, cut at radius 1.5. blackman-harris: the 4-term window of radius 1.5,
// which is also Cycles' default. The latter two are separable and are drawn by their inverse distribution, which is
// monotone, so a stratified u gives stratified positions. With v = 2u - 1 the inverse is v P(-ln(1 - c v^2)), a shape
// that fits bell curves well (Giles 2010 uses it for erfinv); c and P were fitted to numerical inversion. Their density
// is off by less than 0.03 % (gaussian) and 0.3 % (blackman-harris; 0.01 % within 1 pixel) for all but 1e-3 of the
// samples.
#ifndef WAVEPATH_FILTER_GLSL
#define WAVEPATH_FILTER_GLSL

#include "kernels/base/config.glsl"
#include "kernels/base/math.glsl"

const float kFilterRadius = 1.5; // of gaussian and blackman-harris

// -ln(1 - (1 - gap) v^2), stretched to [-1, 1]; 1 - v^2 is formed as a product because it cancels at the ends.
vec2 bell_argument(vec2 v, float gap, float stretch) {
  return -log((1.0 - v) * (1.0 + v) + gap * v * v) * stretch - 1.0;
}

vec2 sample_gaussian(vec2 v) {
  vec2 s = bell_argument(v, 5.39230323e-3, 0.382937627);
  vec2 p = 0.718752201 + s * (0.301612339 + s * (-0.0146974623 + s * (-0.00978754915 + s * (0.00472937136 +
           s * (-1.50763835e-4 + s * -4.62627564e-4)))));
  return v * p;
}

vec2 sample_blackman_harris(vec2 v) {
  vec2 s = bell_argument(v, 3e-6, 0.157271054);
  vec2 p = 0.83423858 + s * (0.300078252 + s * (-0.184678256 + s * (0.0277308499 + s * (0.011873955 +
           s * (0.0131638157 + s * (0.0373664498 + s * (-0.0203025729 + s * -0.0193893552)))))));
  return v * p;
}

// Offset from the pixel's centre, in pixels.
vec2 sample_filter(vec2 u) {
  if (kFilter == kFilterCentre) return vec2(0.0);
  vec2 v = signed_unit(u);
  if (kFilter == kFilterBox) return 0.5 * v;
  vec2 bell = kFilter == kFilterGaussian ? sample_gaussian(v) : sample_blackman_harris(v);
  return kFilterRadius * clamp(bell, -1.0, 1.0);
}

// The density itself along one axis, at distance d from the pixel's centre.
float filter_density(float d) {
  if (kFilter == kFilterBox) return abs(d) <= 0.5 ? 1.0 : 0.0;
  if (abs(d) >= kFilterRadius) return 0.0;
  if (kFilter == kFilterGaussian) return exp(-2.0 * d * d) * 0.800044545;
  float c = cos_sin_turns(d / (2.0 * kFilterRadius)).x; // cosines of multiples of the angle by Chebyshev's polynomials
  float window = 0.35875 + c * 0.48829 + (2.0 * c * c - 1.0) * 0.14128 + (4.0 * c * c - 3.0) * c * 0.01168;
  return max(window, 0.0) / (2.0 * kFilterRadius * 0.35875);
}

#endif
