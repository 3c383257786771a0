// Reflectance of an interface: exact for dielectrics, with the tint of KHR_materials_specular; Schlick's approximation
// for conductors.
#ifndef WAVEPATH_FRESNEL_GLSL
#define WAVEPATH_FRESNEL_GLSL

#include "kernels/base/math.glsl"

float pow5(float x) { return (x * x) * (x * x) * x; }

// Schlick's approximation with glTF's F90 = 1.
vec3 fresnel_conductor(vec3 f0, float cos_theta) {
  return f0 + (vec3(1.0) - f0) * pow5(clamp(1.0 - cos_theta, 0.0, 1.0));
}

// Unpolarized reflectance for an incident cosine c >= 0; eta = transmitted / incident ior. Exactly 1 from the critical
// angle on. In the excess e = eta^2 - 1, with both amplitudes rewritten so that nothing cancels as e -> 0: exactly 0 at
// eta = 1.
float fresnel_exact(float c, float eta) {
  float e = (eta - 1.0) * (eta + 1.0);
  float g2 = c * c + e; // (eta cos_t)^2
  float sum = c + sqrt(max(g2, 0.0));
  float s = e / (sum * sum);
  float p = e * (c - 1.0 / sum) / (sum + e * c);
  return e == 0.0 ? 0.0 : g2 <= 0.0 ? 1.0 : min(0.5 * (s * s + p * p), 1.0);
}

// A dielectric interface seen from one side. glTF's F0 and F90 replace the ends of the exact curve: F = mix(f0, f90,
// (F_exact - F0_exact) / (1 - F0_exact)), which is F_exact where both are physical. Total reflection stays total
// whatever f90 is: there is nowhere else for the light to go.
struct Interface {
  vec3 f0;
  float f90;
  float eta;      // transmitted / incident ior; 1 where the ior is "infinite"
  float f0_exact; // negative: infinite ior (KHR_materials_ior: 0), for which the curve is Schlick's
};

Interface make_interface(float ior, vec3 specular_color, float specular, bool entering) {
  Interface i;
  float n = ior > 0.0 ? ior : 1.0; // below 1: of a body within a denser one
  float r = (n - 1.0) / (n + 1.0);
  bool infinite = ior == 0.0;
  i.f0_exact = infinite ? -1.0 : r * r;
  i.f0 = min(specular_color * (infinite ? 1.0 : r * r), vec3(1.0)) * specular;
  i.f90 = specular;
  i.eta = infinite ? 1.0 : entering ? n : 1.0 / n;
  return i;
}

vec3 fresnel_dielectric(Interface i, float c) {
  float f = fresnel_exact(c, i.eta);
  float t = i.f0_exact < 0.0 ? pow5(clamp(1.0 - c, 0.0, 1.0)) : (f - i.f0_exact) / (1.0 - i.f0_exact);
  vec3 curve = clamp(i.f0 * (1.0 - t) + vec3(i.f90 * t), 0.0, 1.0); // t < 0 near Brewster's angle of a large ior
  return i.eta < 1.0 && f == 1.0 ? vec3(1.0) : curve;
}

// ---- coupling of a diffuse base to the interface above it -----------------------------------------------------------

// Fraction of light along a direction with cosine mu that gets past the interface, rough with the given alpha. The
// albedo of a rough interface is close to that of a smooth one met at a cosine blurred upwards; the blur was fitted to
// quadrature of the GGX lobe so as to err on the side of reflection. A white base under it returns between 0.93 (ior
// 1.1: 0.88) and 1.001 of the light, for any roughness, direction and ior <= 3. From ior 2 + sqrt(3) on the curve dips
// below f0 near Brewster's angle; a rough interface mixes directions from all around the dip, so it is filled (left in,
// a white base returned up to 1.12 within 3 degrees of grazing at ior 10). Seen from inside there is no blur.
float blurred_cosine(Interface i, float mu, float alpha) {
  float r = sqrt(max(i.f0_exact, 0.0));
  float low = 1.0 - min(r / 0.15, 1.0);
  float height = 0.75 * pow(max(alpha, 1e-4), 2.0 / 3.0) / (1.0 + 0.7 * alpha);
  height *= (1.0 - low * low * low) * min(1.0, 1.45 - 1.15 * r);
  float blur = height * pow(max(1.0 - mu, 1e-10), 0.3 / max(alpha, 1e-4) + 1.2 - 1.1 * alpha);
  return min(mu + blur, 1.0);
}

bool is_blurred(Interface i, float alpha) { return i.eta >= 1.0 && alpha >= 1e-4; }

float interface_transmittance(Interface i, float mu, float alpha) {
  bool blurred = is_blurred(i, alpha);
  vec3 reflectance = fresnel_dielectric(i, blurred ? blurred_cosine(i, mu, alpha) : mu);
  return 1.0 - max_component(blurred ? max(reflectance, i.f0) : reflectance);
}

// Cosine-weighted mean over the hemisphere of what interface_transmittance holds back, seen from outside. For a smooth
// interface this is a fit in r = (n-1)/(n+1) to quadrature: |error| < 2.1e-4 (1 - mean) for n <= 39. (Walsh's closed
// form cancels badly near n = 1.) Roughness lets the grazing part fade; the rate is chosen from below, by up to 0.5 %.
float interface_mean(Interface i, float alpha) {
  float r = sqrt(max(i.f0_exact, 0.0));
  float polynomial = r * (0.45773441 + r * (1.05981992 - r * 0.49654835));
  float exact = r + (1.0 - r) * (polynomial + 1.62816214 * (sqrt(1.0 - r) - 1.0)) +
                1.16069601 * r * r * log(max(r, 1e-10));
  float t = i.f0_exact < 0.0 ? 1.0 / 21.0 : (exact - i.f0_exact) / (1.0 - i.f0_exact);
  if (alpha >= 1e-4 && t > 0.0) t *= exp(-clamp(4.6 - 8.0 * r, 3.0, 4.2) * alpha);
  return clamp(max_component(i.f0) * (1.0 - t) + i.f90 * t, 0.0, 1.0);
}

#endif
