// KHR_materials_sheen: fibres that stand up from a cloth. The distribution and its shadowing are those of Estevez and
// Kulla, "Production Friendly Microfacet Sheen BRDF" (2017).
#ifndef WAVEPATH_SHEEN_GLSL
#define WAVEPATH_SHEEN_GLSL

#include "kernels/surface/albedo_table.glsl"
#include "kernels/base/math.glsl"
#include "kernels/base/scene_types.h"

struct Sheen {
  vec3 color; // 0 = none
  float roughness;
  uint table;
};

float sheen_alpha(float roughness) { return max(roughness * roughness, kMinSheenAlpha); }

// The paper's fit of the shadowing, for one direction with cosine x <= 0.5.
float sheen_curve(float x, float alpha) {
  float t = (1.0 - alpha) * (1.0 - alpha);
  float a = mix(21.5473, 25.3245, t), b = mix(3.82987, 3.32435, t), c = mix(0.19823, 0.16801, t);
  float d = mix(-1.97760, -1.27393, t), e = mix(-4.32054, -4.85967, t);
  return a / (1.0 + b * pow(x, c)) + d * x + e;
}

float sheen_lambda(float cosine, float alpha) {
  return cosine < 0.5 ? exp(sheen_curve(cosine, alpha))
                      : exp(2.0 * sheen_curve(0.5, alpha) - sheen_curve(1.0 - cosine, alpha));
}

// f |cos(wi)| of a white sheen, both directions on one side.
float eval_sheen(float roughness, vec3 wo, vec3 wi) {
  float alpha = sheen_alpha(roughness);
  vec3 h = normalize(wo + wi);
  float sine = sqrt(clamp(1.0 - h.z * h.z, 0.0, 1.0));
  float distribution = (2.0 + 1.0 / alpha) * pow(sine, 1.0 / alpha) * (0.5 * kInvPi);
  float o = max(wo.z, 1e-6), i = max(wi.z, 1e-6);
  float shadowing = 1.0 + sheen_lambda(o, alpha) + sheen_lambda(i, alpha);
  return distribution * min(1.0 / (4.0 * o * shadowing), i); // visibility at most 1, as the extension has it
}

// Fraction of the light of a direction that reaches the lobes below the sheen.
float sheen_passes(Sheen sheen, vec3 w) {
  return 1.0 - max_component(sheen.color) * table_albedo(sheen.table, abs(w.z), sheen.roughness);
}

#endif
