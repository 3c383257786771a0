// Puts the layer that was peeled last under those before it.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/transparency/found_layer.glsl"

void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint pixel_index = wave.first_pixel + gl_GlobalInvocationID.x;
  vec4 above = wave.bounce == 0u ? vec4(0.0, 0.0, 0.0, 1.0) : layers[pixel_index], light;
  if (found_layer(pixel_index, light))
    above = vec4(above.rgb + above.a * light.a * light.rgb, above.a * (1.0 - light.a));
  layers[pixel_index] = above;
}
