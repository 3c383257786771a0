// Four moments of depths from -1 to 1 in 16 bits each: turned first so that they fill what the bits can tell apart
// (Peters, Muenstermann, Wetzstein and Klein 2017). Quantised values are held as floats.
#ifndef WAVEPATH_SHADOW_MOMENTS16_GLSL
#define WAVEPATH_SHADOW_MOMENTS16_GLSL

const float kRoot3 = 1.7320508;

// Packs moments as numbers from 0 to 1.
vec4 numbers_of_moments(vec4 b) {
  return vec4(1.5 * b.x - 2.0 * b.z + 0.5, kRoot3 * (0.5 * b.x - 2.0 / 9.0 * b.z) + 0.5, 4.0 * (b.y - b.w),
              0.5 * (b.y + b.w));
}
vec4 moments_of_numbers(vec4 n) {
  n.xy -= 0.5;
  return vec4(kRoot3 * n.y - n.x / 3.0, n.w + 0.125 * n.z, 0.75 * (kRoot3 * n.y - n.x), n.w - 0.125 * n.z);
}

vec4 quantised(vec4 numbers) { return round(clamp(numbers, 0.0, 1.0) * 65535.0) / 65535.0; }

#endif
