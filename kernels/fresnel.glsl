// How much light an interface reflects: dielectrics exactly, with the tint of KHR_materials_specular, conductors by
// Schlick.
#ifndef WAVEPATH_FRESNEL_GLSL
#define WAVEPATH_FRESNEL_GLSL

#include "kernels/math.glsl"

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
  float n = max(ior, 1.0);
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

// Cosine-weighted mean over the hemisphere of max_component(fresnel_dielectric). Seen from outside, the exact curve has
// the mean fitted here in r = (n-1)/(n+1) to numerical quadrature: |error| < 2.1e-4 (1 - mean) for n <= 39. (Walsh's
// closed form cancels badly near n = 1.) Seen from inside, a part 1 - 1/n^2 of the hemisphere is totally reflected and
// the rest mirrors the outside: 1 - mean_in = (1 - mean_out) / n^2.
float fresnel_mean(Interface i) {
  float r = sqrt(max(i.f0_exact, 0.0));
  float polynomial = r * (0.45773441 + r * (1.05981992 - r * 0.49654835));
  float exact = r + (1.0 - r) * (polynomial + 1.62816214 * (sqrt(1.0 - r) - 1.0)) +
                1.16069601 * r * r * log(max(r, 1e-10));
  float t = i.f0_exact < 0.0 ? 1.0 / 21.0 : (exact - i.f0_exact) / (1.0 - i.f0_exact);
  float mean = clamp(max_component(i.f0) * (1.0 - t) + i.f90 * t, 0.0, 1.0);
  float shrink = min(i.eta, 1.0);
  return 1.0 - (1.0 - mean) * (shrink * shrink);
}

#endif
