// Places the corners of every triangle in the picture of a hybrid frame. They are read from where traversal reads them;
// there are no vertex buffers.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_HYBRID
#include "kernels/hybrid/bindings.glsl"
#include "kernels/hybrid/frame_corner.glsl"

// Not gl_PrimitiveID, which fragment shaders may read only with an optional feature.
layout(location = 0) flat out uint triangle;
layout(location = 1) flat out uint instance;
layout(location = 2) flat out uint hidden_sides; // see hidden_sides_of()

void main() {
  uint corner = uint(gl_VertexIndex);
  triangle = corner / 3u;
  instance = uint(gl_InstanceIndex);
  hidden_sides = hidden_sides_of(triangle, instance);
  gl_Position = clip_corner(triangle, corner % 3u, instance);
}
