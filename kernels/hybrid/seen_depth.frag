// Leaves the depth of what a hybrid frame sees in each pixel, whatever else is in front of it.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_VISIBILITY
#include "kernels/hybrid/bindings.glsl"

layout(location = 0) flat in uvec2 drawn; // triangle, instance

void main() {
  uvec2 pixel = uvec2(gl_FragCoord.xy);
  if (texelFetch(visibility, int(pixel.y * frame.width + pixel.x)).xy != drawn) discard;
}
