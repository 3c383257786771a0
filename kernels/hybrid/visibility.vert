// Places the corners of every triangle in the picture of a hybrid frame. They are read from where traversal reads them; there
// are no vertex buffers.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_HYBRID
#include "kernels/hybrid/bindings.glsl"
#include "kernels/camera.glsl"
#include "kernels/triangle.glsl"

// Not gl_PrimitiveID, which fragment shaders may read only with an optional feature.
layout(location = 0) flat out uint triangle;
layout(location = 1) flat out uint instance;
layout(location = 2) flat out uint hidden_sides; // 1: the clockwise one, 2: the other

void main() {
  uint corner = uint(gl_VertexIndex);
  triangle = corner / 3u;
  instance = uint(gl_InstanceIndex);
  hidden_sides = 0u;
  if (CULLS_BACKS) {
    // A transform that mirrors shows the back counter-clockwise.
    bool mirrors = has(kFeatureInstances) && frame.root_is_top != 0u &&
                   floatBitsToUint(texelFetch(instances, int(instance * kInstanceTexels + 6u)).y) != 0u;
    uint flags = floatBitsToUint(texelFetch(triangles, int(triangle * kTriangleTexels)).w);
    if ((flags & kTriangleSingleSided) != 0u) hidden_sides = mirrors ? 2u : 1u;
  }
  vec3 p = texelFetch(triangles, int(triangle * kTriangleTexels + corner % 3u)).xyz;
  if (has(kFeatureInstances) && frame.root_is_top != 0u) p = transform_point(instance * kInstanceTexels + 3u, p);

  // The inverse of camera_ray(): right, up and forward are at right angles.
  vec3 q = p - frame.camera_position;
  vec2 place = vec2(dot(q, frame.camera_right) / dot(frame.camera_right, frame.camera_right),
                    dot(q, frame.camera_up) / dot(frame.camera_up, frame.camera_up));
  float depth = dot(q, frame.camera_forward);
  // Pixels are sampled in their centres, so that the picture moves against the jitter. Clip space has y downwards.
  vec2 shift = 2.0 * hybrid.jitter / vec2(frame.width, frame.height);
  vec2 flipped = vec2(place.x, -place.y);
  // Reversed z: near / depth has the same relative precision at every depth, which floats then keep.
  gl_Position = is_orthographic() ? vec4(flipped - shift, 1.0 - depth / hybrid.far, 1.0)
                                  : vec4(flipped - shift * depth, hybrid.near, depth);
}
