// The fraction of a list of depths that is not below another depth, as moments of the list bound it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernels/base/gpu.h"
#include "kernels/hybrid/shadows/bounds.glsl"
#include "kernels/hybrid/shadows/moments16.glsl"

layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Push { uint invocations; };
struct Case {
  float depth, exponent;
  uint first, count;
};
struct Answers {
  float variance, exponential, warped, four, four16;
};
layout(set = 0, binding = 0, std430) readonly buffer Cases { Case cases[]; };
layout(set = 0, binding = 1, std430) readonly buffer Depths { float depths[]; };
layout(set = 0, binding = 2, std430) writeonly buffer Results { Answers results[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= invocations) return;
  Case c = cases[i];
  vec4 variance = vec4(0.0), exponential = vec4(0.0), warped = vec4(0.0), four = vec4(0.0);
  float weight = 1.0 / float(c.count);
  for (uint k = c.first; k < c.first + c.count; ++k) {
    variance += weight * variance_moments(depths[k]);
    exponential += weight * exponential_moments(depths[k], c.exponent);
    warped += weight * warped_moments(depths[k], c.exponent);
    four += weight * four_moments(depths[k]);
  }
  vec4 four16 = moments_of_numbers(quantised(numbers_of_moments(four)));
  results[i] = Answers(chebyshev(variance.xy, c.depth), exponential_bound(exponential, c.depth, c.exponent),
                       warped_bound(warped, c.depth, c.exponent), 1.0 - hamburger(four, c.depth, kMomentBias),
                       1.0 - hamburger(four16, c.depth, kMomentBias16));
}
