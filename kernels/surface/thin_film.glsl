// KHR_materials_iridescence: a film of nanometres on a surface, by Belcour and Barla, "A Practical Extension to
// Microfacet Theory for the Modeling of Varying Iridescence" (2017), with Schlick's curve for the base as glTF's
// appendix has it. The film's own interface is exact: by Schlick's curve, a film of no thickness would still reflect
// all light at grazing angles.
#ifndef WAVEPATH_THIN_FILM_GLSL
#define WAVEPATH_THIN_FILM_GLSL

#include "kernels/surface/fresnel.glsl"
#include "kernels/base/math.glsl"

struct Film {
  float weight; // 0 = none
  float ior;
  float nanometres;
};

// The eye's response to interference of this path difference (in nanometres), in linear RGB: the Fourier transform of
// the CIE curves, fitted by Gaussians (section 4 of the paper), at a phase shift by channel of the film's base.
vec3 film_response(float path_difference, vec3 shift) {
  float phase = 2.0 * kPi * path_difference * 1e-9;
  const vec3 kHeight = vec3(5.4856e-13, 4.4201e-13, 5.2481e-13);
  const vec3 kPosition = vec3(1.6810e+06, 1.7953e+06, 2.2084e+06);
  const vec3 kWidth = vec3(4.3278e+09, 9.3046e+09, 6.6121e+09);
  vec3 xyz = kHeight * sqrt(2.0 * kPi * kWidth) * cos(kPosition * phase + shift) * exp(-phase * phase * kWidth);
  xyz.x +=
      9.7470e-14 * sqrt(2.0 * kPi * 4.5282e+09) * cos(2.2399e+06 * phase + shift.x) * exp(-4.5282e+09 * phase * phase);
  xyz /= 1.0685e-7;
  return vec3(dot(xyz, vec3(3.2404542, -1.5371385, -0.4985314)), dot(xyz, vec3(-0.9692660, 1.8760108, 0.0415560)),
              dot(xyz, vec3(0.0556434, -0.2040259, 1.0572252)));
}

vec3 schlick(vec3 f0, float c) { return f0 + (vec3(1.0) - f0) * pow5(clamp(1.0 - c, 0.0, 1.0)); }

// Reflectance of the film above a base of normal reflectance f0, met from vacuum at cosine c.
vec3 film_reflectance(Film film, vec3 f0, float c) {
  float ior = mix(1.0, film.ior, smoothstep(0.0, 0.03, film.nanometres)); // no film has no ior
  float cosine2 = 1.0 - (1.0 - c * c) / (ior * ior); // squared, within the film
  if (cosine2 < 0.0) return vec3(1.0);
  float inside = sqrt(cosine2);
  float above = fresnel_exact(c, ior), through = 1.0 - above;
  vec3 root = sqrt(min(f0, vec3(0.9999)));
  vec3 base_ior = (1.0 + root) / (1.0 - root);
  vec3 step_ = (base_ior - ior) / (base_ior + ior);
  vec3 below = schlick(step_ * step_, inside);
  vec3 shift = vec3(kPi) + vec3(lessThan(base_ior, vec3(ior))) * kPi;

  vec3 product = clamp(above * below, 1e-5, 0.9999);
  vec3 between = through * through * below / (1.0 - product);
  vec3 sum = above + between;
  vec3 order = between - through;
  float difference = 2.0 * ior * film.nanometres * inside;
  for (int m = 1; m <= 2; ++m) {
    order *= sqrt(product);
    sum += order * (2.0 * film_response(float(m) * difference, float(m) * shift));
  }
  return clamp(sum, 0.0, 1.0);
}

#endif
