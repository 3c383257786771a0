// Evaluates kernels/base/sampler.glsl for a block of (pixel, dimension, sample), samples innermost.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernels/base/sampler.glsl"

layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Push { uint invocations; };
layout(set = 0, binding = 0, std430) readonly buffer Parameters {
  uint seed;
  uint sample_total;
  uint first_pixel;
  uint first_dimension;
  uint dimension_count;
  uint first_sample;
  uint sample_count;
  uint mode; // 0 = sample_2d, 1 = hash_unit(dimension, pixel) in x, 2 = unit_float of the pixel's bits in x
};
layout(set = 0, binding = 1, std430) writeonly buffer Points { vec2 points[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= invocations) return;
  uint block = i / sample_count;
  uint sample_index = first_sample + i % sample_count;
  uint dimension = first_dimension + block % dimension_count;
  uint pixel = first_pixel + block / dimension_count;
  Sampler s = make_sampler(seed, pixel, sample_index, sample_total);
  if (mode == 0u) points[i] = sample_2d(s, dimension);
  else if (mode == 1u) points[i] = vec2(hash_unit(s, dimension, pixel), 0.0);
  else points[i] = vec2(unit_float(pixel), 0.0);
}
