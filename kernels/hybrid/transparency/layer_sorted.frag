// A layer that is drawn over those behind it.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/transparency/layer_fragment.glsl"
#include "kernels/hybrid/transparency/layer_light.glsl"

layout(location = 0) out vec4 drawn;

void main() {
  Fragment f;
  if (!is_in_front(f)) discard;
  vec4 light = layer_light(f.hit, f.pixel, f.origin, f.direction);
  drawn = vec4(light.rgb * light.a, light.a);
}
