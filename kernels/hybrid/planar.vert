// Flattens the corners of every triangle onto a plane, away from a light, and places them in the picture of a hybrid
// frame (Blinn 1988).
//
// The flattened point is homogeneous, and its w is negative where the corner is beyond the light: clipping takes away
// that part of a triangle, which would else be an antishadow.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_PLANAR_PAIRS
#define BIND_HYBRID
#include "kernels/hybrid/bindings.glsl"
#include "kernels/hybrid/shadows/bindings.glsl"
#include "kernels/base/camera.glsl"
#include "kernels/hybrid/shadows/planar.glsl"

layout(location = 0) flat out uint triangle;
layout(location = 1) flat out uint instance;
layout(location = 2) out vec3 position; // position of the caster, device world space
layout(location = 3) out float height;  // height of the caster above the plane

void main() {
  triangle = uint(gl_VertexIndex) / 3u;
  instance = uint(gl_InstanceIndex);
  position = placed_corner(triangle, instance, uint(gl_VertexIndex) % 3u);
  PlanarPair pair = fetch_planar_pair(wave.first_pixel);
  height = height_above(pair, position);
  if (is_of_plane(pair, triangle, instance)) { // a receiver, no caster: it covers nothing
    gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
    return;
  }
  // Position as in kernels/hybrid/visibility.vert, for the point q / w, relative to the eye.
  float w = pair.height - height * pair.is_point;
  vec3 q =
      pair.height * (position - frame.camera_position) - height * (pair.light - pair.is_point * frame.camera_position);
  vec2 position = vec2(dot(q, frame.camera_right) / dot(frame.camera_right, frame.camera_right),
                    dot(q, frame.camera_up) / dot(frame.camera_up, frame.camera_up));
  float depth = dot(q, frame.camera_forward);
  vec2 shift = 2.0 * hybrid.jitter / vec2(frame.width, frame.height);
  vec2 flipped = vec2(position.x, -position.y);
  gl_Position = is_orthographic() ? vec4(flipped - shift * w, 0.5 * w, w)
                                  : vec4(flipped - shift * depth, hybrid.near * w, depth);
}
