// Places the corners of every triangle in the picture of a hybrid frame, for its depth.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_HYBRID
#include "kernels/hybrid/bindings.glsl"
#include "kernels/hybrid/frame_corner.glsl"

layout(location = 0) flat out uvec2 drawn; // triangle, instance

invariant gl_Position; // as in volume.vert

void main() {
  uint corner = uint(gl_VertexIndex);
  drawn = uvec2(corner / 3u, gl_InstanceIndex);
  gl_Position = clip_corner(drawn.x, corner % 3u, drawn.y);
}
