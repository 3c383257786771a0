// Tone curves from their published formulas; each is written as one function of a colour.
#include "host/picture/tonemap.h"

#include <algorithm>
#include <cmath>

#include "host/codecs/srgb.h"

namespace wavepath {
namespace {

using glm::mat3;
using glm::vec3;

float max_component(vec3 c) { return std::max({c.x, c.y, c.z}); }
float min_component(vec3 c) { return std::min({c.x, c.y, c.z}); }

// https://github.com/KhronosGroup/ToneMapping, PBR_Neutral. Removes the Fresnel offset of a dielectric, then compresses
// the brightest channel above 0.76 towards 1 and lets the colour fade to white as it does.
vec3 khronos_neutral(vec3 c) {
  constexpr float kFresnel = 0.04f, kStart = 0.8f - kFresnel, kDesaturation = 0.15f;
  const float least = min_component(c);
  c -= least < 2.0f * kFresnel ? least - least * least / (4.0f * kFresnel) : kFresnel;

  const float peak = max_component(c);
  if (peak < kStart) return c;
  constexpr float kHeadroom = 1.0f - kStart;
  const float new_peak = 1.0f - kHeadroom * kHeadroom / (peak + kHeadroom - kStart);
  const float fade = 1.0f / (kDesaturation * (peak - new_peak) + 1.0f);
  return glm::mix(vec3(new_peak), c * (new_peak / peak), fade);
}

// Rows of the matrices as published; GLM wants columns.
vec3 aces_fitted(vec3 c) {
  const mat3 input = glm::transpose(mat3(0.59719f, 0.35458f, 0.04823f,    //
                                         0.07600f, 0.90834f, 0.01566f,    //
                                         0.02840f, 0.13383f, 0.83777f));  // sRGB to AP1, with the RRT's saturation
  const mat3 output = glm::transpose(mat3(1.60475f, -0.53108f, -0.07367f, //
                                          -0.10208f, 1.10813f, -0.00605f, //
                                          -0.00327f, -0.07276f, 1.07602f));
  const vec3 v = input * c;
  return output * ((v * (v + 0.0245786f) - 0.000090537f) / (v * (0.983729f * v + 0.4329510f) + 0.238081f));
}

// Log encoding over 16.5 stops around middle grey, a sigmoid fitted by a sixth-degree polynomial, and back.
vec3 agx_base(vec3 c) {
  const mat3 inset(0.842479062253094f, 0.0423282422610123f, 0.0423756549057051f, //
                   0.0784335999999992f, 0.878468636469772f, 0.0784336f,          //
                   0.0792237451477643f, 0.0791661274605434f, 0.879142973793104f);
  const mat3 outset(1.19687900512017f, -0.0528968517574562f, -0.0529716355144438f, //
                    -0.0980208811401368f, 1.15190312990417f, -0.0980434501171241f, //
                    -0.0990297440797205f, -0.0989611768448433f, 1.15107367264116f);
  constexpr float kMinStops = -12.47393f, kMaxStops = 4.026069f;
  vec3 x = inset * c;
  for (int i = 0; i < 3; ++i)
    x[i] = (std::clamp(std::log2(std::max(x[i], 1e-10f)), kMinStops, kMaxStops) - kMinStops) / (kMaxStops - kMinStops);

  const vec3 x2 = x * x, x4 = x2 * x2;
  x = 15.5f * x4 * x2 - 40.14f * x4 * x + 31.96f * x4 - 6.868f * x2 * x + 0.4298f * x2 + 0.1191f * x - 0.00232f;
  x = glm::max(outset * x, vec3(0.0f));
  return glm::pow(x, vec3(2.2f)); // the fit is of display values
}

} // namespace

vec3 tonemap(Tonemap curve, vec3 radiance) {
  // Beyond 2^40 every curve is white, and no product below overflows.
  constexpr float kBrightest = 1.0995e12f;
  for (int i = 0; i < 3; ++i) radiance[i] = radiance[i] > 0.0f ? std::min(radiance[i], kBrightest) : 0.0f;
  vec3 c = radiance;
  if (curve == Tonemap::aces) c = aces_fitted(radiance);
  if (curve == Tonemap::agx) c = agx_base(radiance);
  if (curve == Tonemap::neutral) c = khronos_neutral(radiance);
  return glm::clamp(c, 0.0f, 1.0f);
}

float to_srgb(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

float from_srgb(float encoded) { return static_cast<float>(linear_from_srgb(encoded)); }

} // namespace wavepath
