// Tone curves, which map linear radiance to display values: those of host/picture/tonemap.cpp, which names their
// sources.
#ifndef WAVEPATH_TONEMAP_GLSL
#define WAVEPATH_TONEMAP_GLSL

#include "kernels/display/display_types.h"

vec3 tonemap_neutral(vec3 c) {
  const float kFresnel = 0.04, kStart = 0.8 - kFresnel, kDesaturation = 0.15, kHeadroom = 1.0 - kStart;
  float least = min(c.r, min(c.g, c.b));
  c -= least < 2.0 * kFresnel ? least - least * least / (4.0 * kFresnel) : kFresnel;
  float peak = max(c.r, max(c.g, c.b));
  if (peak < kStart) return c;
  float new_peak = 1.0 - kHeadroom * kHeadroom / (peak + kHeadroom - kStart);
  float fade = 1.0 / (kDesaturation * (peak - new_peak) + 1.0);
  return mix(vec3(new_peak), c * (new_peak / peak), fade);
}

// The matrices are given by columns.
vec3 tonemap_aces(vec3 c) {
  const mat3 kInput = mat3(0.59719, 0.07600, 0.02840, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777);
  const mat3 kOutput = mat3(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602);
  vec3 v = kInput * c;
  return kOutput * ((v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081));
}

vec3 tonemap_agx(vec3 c) {
  const mat3 kInset = mat3(0.842479062253094, 0.0423282422610123, 0.0423756549057051, //
                           0.0784335999999992, 0.878468636469772, 0.0784336,          //
                           0.0792237451477643, 0.0791661274605434, 0.879142973793104);
  const mat3 kOutset = mat3(1.19687900512017, -0.0528968517574562, -0.0529716355144438, //
                            -0.0980208811401368, 1.15190312990417, -0.0980434501171241, //
                            -0.0990297440797205, -0.0989611768448433, 1.15107367264116);
  const float kMinStops = -12.47393, kMaxStops = 4.026069;
  vec3 x = (clamp(log2(max(kInset * c, vec3(1e-10))), kMinStops, kMaxStops) - kMinStops) / (kMaxStops - kMinStops);
  vec3 x2 = x * x, x4 = x2 * x2;
  x = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232;
  return pow(max(kOutset * x, vec3(0.0)), vec3(2.2));
}

// Linear sRGB in [0,1] of any radiance; negative channels count as 0.
vec3 tonemap(uint curve, vec3 radiance) {
  const float kBrightest = 1.0995e12; // beyond it every curve is white
  vec3 c = clamp(radiance, vec3(0.0), vec3(kBrightest));
  if (curve == kTonemapAces) c = tonemap_aces(c);
  if (curve == kTonemapAgx) c = tonemap_agx(c);
  if (curve == kTonemapNeutral) c = tonemap_neutral(c);
  return clamp(c, 0.0, 1.0);
}

// The sRGB transfer function (IEC 61966-2-1).
vec3 to_srgb(vec3 linear) {
  return mix(1.055 * pow(max(linear, vec3(1e-6)), vec3(1.0 / 2.4)) - 0.055, 12.92 * linear,
             lessThanEqual(linear, vec3(0.0031308)));
}

#endif
