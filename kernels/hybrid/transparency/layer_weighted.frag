// A layer that is added to the others in any order, with a weight that falls with its depth (McGuire and Bavoil 2013,
// equation 9).
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/transparency/layer_fragment.glsl"
#include "kernels/hybrid/transparency/layer_light.glsl"

// Light times weight, and its opacity; the weight.
layout(location = 0) out vec4 drawn;
layout(location = 1) out vec4 weight;

void main() {
  Fragment f;
  if (!is_in_front(f)) discard;
  vec4 light = layer_light(f.hit, f.pixel, f.origin, f.direction);
  float z = f.depth, by_depth = clamp(0.03 / (1e-5 + pow(z / 200.0, 4.0)), 1e-2, 3e3);
  float w = light.a * by_depth;
  drawn = vec4(light.rgb * w, light.a);
  weight = vec4(w, 0.0, 0.0, light.a);
}
