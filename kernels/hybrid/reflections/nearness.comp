// One level of the pyramid of nearness. Push constant: bounce = the level, first_pixel = its first cell, row by row
// from the top left, pixel_count = how many cells.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_HYBRID
#define BIND_GBUFFER
#include "kernels/hybrid/bindings.glsl"
#include "kernels/base/config.glsl"
#include "kernels/hybrid/reflections/bindings.glsl"
#include "kernels/hybrid/reflections/screen.glsl"

layout(local_size_x = kWorkgroupSize) in;

float nearest_below(uvec2 cell, uint level) {
  uvec2 size = level_size(level - 1u);
  uint start = level_start(level - 1u);
  float nearest = kNothing;
  for (uint i = 0u; i < 4u; ++i) {
    uvec2 child = 2u * cell + uvec2(i & 1u, i >> 1u);
    if (child.x < size.x && child.y < size.y) nearest = max(nearest, nearness[start + child.y * size.x + child.x]);
  }
  return nearest;
}

void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint index = wave.first_pixel + gl_GlobalInvocationID.x, level = wave.bounce;
  uvec2 size = level_size(level);
  float depth = level == 0u ? gbuffer[index].depth : 0.0;
  float here = depth > 0.0 ? nearness_of(depth) : kNothing;
  if (level > 0u) here = nearest_below(uvec2(index % size.x, index / size.x), level);
  nearness[level_start(level) + index] = here;
}
