// Places the corners of every triangle in a light's view. They are read from where traversal reads them.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#include "kernels/shadows/bindings.glsl"
#include "kernels/config.glsl"
#include "kernels/shadows/view.glsl"
#include "kernels/triangle.glsl"

layout(location = 0) flat out uint triangle;
layout(location = 1) flat out uint instance;
layout(location = 2) out vec3 position; // device world

void main() {
  triangle = uint(gl_VertexIndex) / 3u;
  instance = uint(gl_InstanceIndex);
  position = texelFetch(triangles, int(triangle * kTriangleTexels + uint(gl_VertexIndex) % 3u)).xyz;
  if (has(kFeatureInstances) && frame.root_is_top != 0u) position = transform_point(instance * kInstanceTexels + 3u, position);
  gl_Position = view_position(fetch_shadow_view(wave.first_pixel), position);
}
