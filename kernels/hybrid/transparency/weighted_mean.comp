// The weighted mean of all layers, as opaque as they are together (McGuire and Bavoil 2013, equation 7).
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_LAYERS
#include "kernels/hybrid/bindings.glsl"
#include "kernels/hybrid/transparency/transparency_types.h"

layout(set = 0, binding = kBindLayerSums) uniform samplerBuffer layer_sums;
layout(set = 0, binding = kBindLayerWeights) uniform samplerBuffer layer_weights;

layout(local_size_x = kWorkgroupSize) in;

// Push constant: first_pixel = the first one, row by row from the top left, pixel_count = how many.
void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint pixel_index = wave.first_pixel + gl_GlobalInvocationID.x;
  vec4 sum = texelFetch(layer_sums, int(pixel_index));
  float weight = texelFetch(layer_weights, int(pixel_index)).x;
  layers[pixel_index] = weight > 0.0 ? vec4(sum.rgb * ((1.0 - sum.a) / weight), sum.a) : vec4(0.0, 0.0, 0.0, 1.0);
}
