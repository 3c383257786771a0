// Hands out the light that denoise_split.comp took from rare bright samples: one iteration of a 3x3 filter with holes
// that does not cross the edges of surfaces, and does not look at brightness.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/denoise.glsl"

layout(set = 0, binding = kFilterColorOut, std430) writeonly buffer ColorBlock { vec4 color_out[]; };
layout(set = 0, binding = kFilterGuideIn) uniform usamplerBuffer guide_in;
layout(set = 0, binding = kFilterSlopeTexels) uniform usamplerBuffer slope_texels;

void main() {
  int step = int(band.step);
  ivec2 pixel = lane_pixel();
  if (!in_picture(pixel)) return;
  int index = pixel_index(pixel);
  uvec4 here = texelFetch(guide_in, index);
  vec3 normal = unpack_normal(here.x);
  vec2 slope = uintBitsToFloat(texelFetch(slope_texels, index).xy);
  vec3 sum = vec3(0.0);
  float weights = 0.0;
  for (int y = -1; y <= 1; ++y) {
    for (int x = -1; x <= 1; ++x) {
      ivec2 offset = ivec2(x, y) * step;
      int index = pixel_index(pixel + offset);
      Likeness likeness = compare_shapes(here, normal, slope, texelFetch(guide_in, index), vec2(offset));
      float fraction = in_picture(pixel + offset) ? likeness.weight / float(1 << (abs(x) + abs(y))) : 0.0;
      float weight = fraction * exp(-likeness.distance);
      sum += weight * texelFetch(color_in, index).xyz;
      weights += weight;
    }
  }
  color_out[index] = vec4(weights > 0.0 ? sum / weights : vec3(0.0), 0.0);
}
