// Numerics that Vulkan leaves loose, done here: trigonometry, warps of the unit square, finiteness, error-bounded ray
// origins.
//
// Vulkan allows sin and cos an absolute error of 2^-11, atan 4096 ulp, and isnan() to be folded away; Mesa's acos errs
// by 4e-4. What follows uses additions, multiplications, divisions and square roots alone.
#ifndef WAVEPATH_MATH_GLSL
#define WAVEPATH_MATH_GLSL

const float kPi = 3.14159265358979;
const float kInvPi = 0.318309886183791;
const float kOneMinusEpsilon = 0.99999994; // 1 - 2^-24, the largest float below 1

float luminance(vec3 rgb) { return dot(rgb, vec3(0.2126, 0.7152, 0.0722)); } // Rec. 709
float max_component(vec3 v) { return max(v.x, max(v.y, v.z)); }

// From the bits, because a compiler may assume that floats are finite.
bool is_finite(float x) { return (floatBitsToUint(x) & 0x7f800000u) != 0x7f800000u; }
bool is_finite(vec3 v) { return is_finite(v.x) && is_finite(v.y) && is_finite(v.z); }

// The top 24 bits as a multiple of 2^-24, so never 1.
float unit_float(uint bits) { return float(bits >> 8u) * 5.9604645e-8; }
vec2 unit_float(uvec2 bits) { return vec2(bits >> 8u) * 5.9604645e-8; }

// v / |v|, or `fallback` where v has no direction. Scaled first: squares of components outside [1e-19, 1e19] leave the
// float range.
vec3 safe_normalize(vec3 v, vec3 fallback) {
  float scale = max_component(abs(v));
  if (!(scale > 0.0) || !is_finite(scale)) return fallback;
  vec3 w = v / scale;
  return w / sqrt(dot(w, w));
}

// ---- angles -----------------------------------------------------------------------------------------------------

// (cos, sin) of 2 pi r for |r| <= 1/8: minimax polynomials, error below 4e-9 before rounding.
vec2 cos_sin_octant(float r) {
  float q = r * r;
  float c = 1.0 + q * (-19.7392087 + q * (64.9393265 + q * (-85.4437418 + q * 59.2459684)));
  float s = r * (6.28318529 + q * (-41.3416627 + q * (81.5925586 + q * -75.4022499)));
  return vec2(c, s);
}

// (cos, sin) of 2 pi * turns. The reduction to a quarter turn is exact, so |error| < 2e-7 for any |turns| < 2^22.
vec2 cos_sin_turns(float turns) {
  float quarter = floor(turns * 4.0 + 0.5);
  vec2 cs = cos_sin_octant(turns - 0.25 * quarter);
  int q = int(quarter);
  vec2 swapped = (q & 1) != 0 ? vec2(-cs.y, cs.x) : cs;
  return (q & 2) != 0 ? -swapped : swapped;
}

// Angle of (x, y) in [-pi, pi], |error| < 4e-7; 0 at the origin.
float atan2_exact(float y, float x) {
  vec2 a = abs(vec2(x, y));
  float hi = max(a.x, a.y);
  float t = hi > 0.0 ? min(a.x, a.y) / hi : 0.0;
  float q = t * t;
  float p = t + t * q * (-0.333331802 + q * (0.19994399 + q * (-0.142161192 + q * (0.106858799 + q * (-0.0759447177 +
                q * (0.0437094504 + q * (-0.0166731118 + q * 0.00299676356)))))));
  if (a.y > a.x) p = 0.5 * kPi - p;
  if (x < 0.0) p = kPi - p;
  return y < 0.0 ? -p : p;
}

// Angle in [0, pi] whose cosine is x; x beyond [-1, 1] is clamped.
float acos_exact(float x) { return atan2_exact(sqrt(max(0.0, (1.0 - x) * (1.0 + x))), x); }

// ---- powers of two ----------------------------------------------------------------------------------------------

// -log2(x) of x in (0, 1]: from the mantissa by the series of atanh, error below 2e-7 of the result or 1e-7.
float minus_log2(float x) {
  uint bits = floatBitsToUint(max(x, 1.17549435e-38));
  int exponent = int(bits >> 23u) - 127;
  float m = uintBitsToFloat((bits & 0x7fffffu) | 0x3f800000u);
  if (m > 1.41421356) {
    m *= 0.5;
    ++exponent;
  }
  float s = (m - 1.0) / (m + 1.0), q = s * s;
  return -(float(exponent) +
           2.88539008 * s * (1.0 + q * (0.333333333 + q * (0.2 + q * (0.142857143 + q * 0.111111111)))));
}

// 2^-(whole + part) for part in [0, 1), error below 2e-7 of the result: a Taylor series about 1/2.
float exp2_minus(uint whole, float part) {
  float x = (0.5 - part) * 0.693147181;
  float power = 0.707106781 * (1.0 + x * (1.0 + x * (0.5 + x * (0.166666667 + x * (0.0416666667 + x * (0.00833333333 +
                    x * (0.00138888889 + x * 0.000198412698)))))));
  return whole < 126u ? power * uintBitsToFloat((127u - whole) << 23u) : 0.0;
}

// ---- local bases ------------------------------------------------------------------------------------------------

// Tangent and bitangent of the unit vector n, without a branch and without a singularity (Duff et al., JCGT 2017).
void make_basis(vec3 n, out vec3 tangent, out vec3 bitangent) {
  float s = n.z < 0.0 ? -1.0 : 1.0;
  float a = -1.0 / (s + n.z);
  float b = n.x * n.y * a;
  tangent = vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x);
  bitangent = vec3(b, s + n.y * n.y * a, -n.y);
}

vec3 to_local(vec3 v, vec3 tangent, vec3 bitangent, vec3 n) {
  return vec3(dot(v, tangent), dot(v, bitangent), dot(v, n));
}
vec3 to_world(vec3 v, vec3 tangent, vec3 bitangent, vec3 n) {
  return v.x * tangent + v.y * bitangent + v.z * n;
}

// ---- warps of u in [0,1)^2, each beside its density -------------------------------------------------------------

// u stretched to (-1, 1). A multiple of 2^-24 plus half a step is exact, so the lattice of the samplers comes out
// symmetric and clear of 0 and of the ends.
vec2 signed_unit(vec2 u) { return clamp((2.0 * u - 1.0) + 5.9604645e-8, -kOneMinusEpsilon, kOneMinusEpsilon); }

// Concentric map (Shirley and Chiu 1997). On that lattice it meets neither the middle, where the map is singular, nor
// the rim, where a cosine-weighted direction has no density.
vec2 warp_disk(vec2 u) {
  vec2 a = signed_unit(u);
  if (a == vec2(0.0)) return a;
  bool steep = abs(a.y) > abs(a.x);
  float r = steep ? a.y : a.x;
  vec2 cs = cos_sin_octant(0.125 * (steep ? a.x : a.y) / r);
  return r * (steep ? cs.yx : cs);
}
float warp_disk_pdf() { return kInvPi; }

vec3 warp_cosine_hemisphere(vec2 u) {
  vec2 d = warp_disk(u);
  return vec3(d, sqrt(max(1.0 - dot(d, d), 1e-7))); // 1e-7: rounding at the rim, where the true value is 1.2e-7
}
float warp_cosine_hemisphere_pdf(float cos_theta) { return max(cos_theta, 0.0) * kInvPi; }

vec3 warp_uniform_hemisphere(vec2 u) {
  float z = 1.0 - u.x; // in (0, 1]
  return vec3(sqrt(u.x * (1.0 + z)) * cos_sin_turns(u.y), z);
}
float warp_uniform_hemisphere_pdf() { return 0.5 * kInvPi; }

vec3 warp_uniform_sphere(vec2 u) { return vec3(2.0 * sqrt(u.x * (1.0 - u.x)) * cos_sin_turns(u.y), 1.0 - 2.0 * u.x); }
float warp_uniform_sphere_pdf() { return 0.25 * kInvPi; }

// Barycentric weights of the second and third vertex, uniform over the area; continuous and with little distortion
// (Heitz 2019, "A Low-Distortion Map Between Triangle and Square").
vec2 warp_triangle(vec2 u) {
  return u.x < u.y ? vec2(0.5 * u.x, u.y - 0.5 * u.x) : vec2(u.x - 0.5 * u.y, 0.5 * u.y);
}
float warp_triangle_pdf(float area) { return 1.0 / area; }

// ---- rounding ---------------------------------------------------------------------------------------------------

// Bound of the relative error of n rounded operations: n eps / (1 - n eps), eps = 2^-24 (Higham 2002).
float gamma_bound(float n) { return n * 5.9604645e-8 / (1.0 - n * 5.9604645e-8); }

float next_float_up(float x) {
  if (!is_finite(x)) return x;
  uint bits = floatBitsToUint(x == 0.0 ? 0.0 : x);
  return uintBitsToFloat(bits < 0x80000000u ? bits + 1u : bits - 1u);
}
float next_float_down(float x) { return -next_float_up(-x); }

// Origin of a ray that leaves p towards w: p is known within +-error per axis, n is the unit normal of the surface
// there. Moves to the far side of the slab that surely holds the surface and rounds away from it (pbrt-v4, 6.8.6), so
// no scale enters.
vec3 offset_ray_origin(vec3 p, vec3 error, vec3 n, vec3 w) {
  precise float distance_ = dot(abs(n), error);
  precise vec3 offset = dot(w, n) < 0.0 ? -distance_ * n : distance_ * n;
  precise vec3 q = p + offset;
  for (int i = 0; i < 3; ++i) {
    if (offset[i] > 0.0) q[i] = next_float_up(q[i]);
    else if (offset[i] < 0.0) q[i] = next_float_down(q[i]);
  }
  return q;
}

#endif
