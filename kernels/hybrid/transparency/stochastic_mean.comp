// Adds a sample of stochastic transparency to the others: the layer that covers it, or what is behind all of them.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/transparency/found_layer.glsl"

void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint pixel_index = wave.first_pixel + gl_GlobalInvocationID.x;
  vec4 sum = wave.bounce == 0u ? vec4(0.0) : layers[pixel_index], light;
  layers[pixel_index] = sum + (found_layer(pixel_index, light) ? vec4(light.rgb, 0.0) : vec4(0.0, 0.0, 0.0, 1.0)) /
                                  float(wave.sample_count);
}
