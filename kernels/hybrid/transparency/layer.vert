// Places the corners of BLEND triangles in the picture of a hybrid frame, in the order of their list.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_HYBRID
#include "kernels/hybrid/bindings.glsl"
#include "kernels/hybrid/frame_corner.glsl"
#include "kernels/hybrid/transparency/transparency_types.h"

layout(set = 0, binding = kBindLayerTriangles) uniform usamplerBuffer layer_triangles;

layout(location = 0) flat out uint triangle;
layout(location = 1) flat out uint instance;
layout(location = 2) flat out uint hidden_sides; // see hidden_sides_of()
layout(location = 3) flat out uint layer;        // index in the list

void main() {
  uint corner = uint(gl_VertexIndex);
  layer = corner / 3u;
  uvec2 placed = texelFetch(layer_triangles, int(layer)).xy;
  triangle = placed.x;
  instance = placed.y;
  hidden_sides = hidden_sides_of(triangle, instance);
  gl_Position = clip_corner(triangle, corner % 3u, instance);
}
