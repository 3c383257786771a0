// Places the corners of every triangle in a light's view, for vertex shaders. They are read from where traversal reads
// them. A shader that defines BIND_RECEIVER_PLANES draws casters alone: what lies in none of these planes.
#ifndef WAVEPATH_SHADOW_VERTEX_GLSL
#define WAVEPATH_SHADOW_VERTEX_GLSL

#define BIND_GEOMETRY
#include "kernels/hybrid/shadows/bindings.glsl"
#include "kernels/base/config.glsl"
#include "kernels/hybrid/shadows/planar.glsl"
#include "kernels/hybrid/shadows/view.glsl"
#include "kernels/bvh/triangle.glsl"

layout(location = 0) flat out uint triangle;
layout(location = 1) flat out uint instance;
layout(location = 2) out vec3 position; // device world
invariant gl_Position; // the same triangles cover the same texels in all passes over a map

void main() {
  triangle = uint(gl_VertexIndex) / 3u;
  instance = uint(gl_InstanceIndex);
  position = placed_corner(triangle, instance, uint(gl_VertexIndex) % 3u);
  gl_Position = view_position(fetch_shadow_view(wave.first_pixel), position);
#ifdef BIND_RECEIVER_PLANES
  if (is_receiver(triangle, instance)) gl_Position = vec4(0.0, 0.0, 0.0, 1.0); // covers nothing
#endif
}

#endif
