// Averages of a distribution of depths, and bounds that they give for the fraction of it that is not below a depth. All
// depths here run from -1, the near end of a view, to 1, its far end.
#ifndef WAVEPATH_SHADOW_BOUNDS_GLSL
#define WAVEPATH_SHADOW_BOUNDS_GLSL

// Smallest variance (Donnelly and Lauritzen 2006), as a fraction of the second moment: what rounding of filtered
// moments may take away from it.
const float kLeastVariance = 1e-6;
const float kMomentBias = 3e-6, kMomentBias16 = 6e-5; // towards a distribution that no rounding takes out of reach

vec4 variance_moments(float depth) { return vec4(depth, depth * depth, 0.0, 0.0); }

// Cantelli's inequality, the one-tailed form of Chebyshev's: at most this fraction is at `depth` or beyond it.
float chebyshev(vec2 moments, float depth) {
  float away = depth - moments.x;
  if (!(away > 0.0)) return 1.0;
  float variance = max(moments.y - moments.x * moments.x, 0.0) + kLeastVariance * moments.y;
  return variance / (variance + away * away);
}

// Exponents are for the whole range of depths.
vec4 exponential_moments(float depth, float exponent) { return vec4(exp(0.5 * exponent * depth), 0.0, 0.0, 0.0); }

// Depths that are not below count at least as 1 in the mean of exponentials, all others as next to nothing.
float exponential_bound(vec4 moments, float depth, float exponent) {
  return min(moments.x * exp(-0.5 * exponent * depth), 1.0);
}

// Two warps (Lauritzen and McCool 2008): one stretches what is far and presses what is near together, the other one
// does the opposite.
const float kNegativeExponent = 10.0;
vec2 warp_depth(float depth, float exponent) {
  return vec2(exp(0.5 * exponent * depth), -exp(-0.5 * min(exponent, kNegativeExponent) * depth));
}
vec4 warped_moments(float depth, float exponent) {
  vec2 warped = warp_depth(depth, exponent);
  return vec4(warped.x, warped.x * warped.x, warped.y, warped.y * warped.y);
}
float warped_bound(vec4 moments, float depth, float exponent) {
  vec2 warped = warp_depth(depth, exponent);
  return min(chebyshev(moments.xy, warped.x), chebyshev(moments.zw, warped.y));
}

vec4 four_moments(float depth) {
  float square = depth * depth;
  return vec4(depth, square, square * depth, square * square);
}

// Fraction of the distribution that is below `depth` at the least, from four moments (Peters and Klein 2015,
// Hamburger's moment problem). Of all distributions with these moments, the one with a part at `depth` and two others
// has it.
float hamburger(vec4 moments, float depth, float bias) {
  vec4 b = mix(moments, vec4(0.0, 0.375, 0.0, 0.375), bias);
  // Cholesky's decomposition of the Hankel matrix (1 b0 b1; b0 b1 b2; b1 b2 b3), which solves it for (1, depth,
  // depth^2).
  float l21 = b.x, d22 = b.y - b.x * b.x, l32_d22 = b.z - b.x * b.y;
  float l32 = l32_d22 / d22, d33 = max(b.w - b.y * b.y - l32_d22 * l32, 1e-12);
  vec3 c = vec3(1.0, depth, depth * depth);
  c.y -= l21 * c.x;
  c.z -= b.y * c.x + l32 * c.y;
  c.y /= d22;
  c.z /= d33;
  c.y -= l32 * c.z;
  c.x -= l21 * c.y + b.y * c.z;
  // The two other parts are where this polynomial is zero.
  float p = c.y / c.z, q = c.x / c.z, root = sqrt(max(0.25 * p * p - q, 0.0));
  float lower = -0.5 * p - root, upper = -0.5 * p + root;
  if (depth <= lower) return 0.0;
  if (depth <= upper)
    return (depth * upper - b.x * (depth + upper) + b.y) / ((upper - lower) * (depth - lower));
  return 1.0 - (lower * upper - b.x * (lower + upper) + b.y) / ((depth - lower) * (depth - upper));
}

#endif
