// Clip-space position of a triangle's corner in a hybrid frame, and the sides of the triangle that are not there.
// Include bindings.glsl with BIND_GEOMETRY and BIND_HYBRID first.
#ifndef WAVEPATH_FRAME_CORNER_GLSL
#define WAVEPATH_FRAME_CORNER_GLSL

#include "kernels/base/camera.glsl"
#include "kernels/bvh/instance.glsl"

// 1: the clockwise side, 2: the other.
uint hidden_sides_of(uint triangle, uint instance) {
  if (!CULLS_BACKS) return 0u;
  // A transform that mirrors shows the back counter-clockwise.
  bool mirrors = has(kFeatureInstances) && frame.root_is_top != 0u &&
                 floatBitsToUint(texelFetch(instances, int(instance * kInstanceTexels + 6u)).y) != 0u;
  uint flags = floatBitsToUint(texelFetch(triangles, int(triangle * kTriangleTexels)).w);
  return (flags & kTriangleSingleSided) == 0u ? 0u : mirrors ? 2u : 1u;
}

// Reversed z: near / depth has the same relative precision at every depth, which floats then keep.
float clip_depth(float depth) { return is_orthographic() ? 1.0 - depth / hybrid.far : hybrid.near / depth; }

// Position of a corner in the device's world space.
vec3 corner_position(uint triangle, uint corner, uint instance) {
  vec3 p = texelFetch(triangles, int(triangle * kTriangleTexels + corner)).xyz;
  return has(kFeatureInstances) && frame.root_is_top != 0u ? transform_point(instance * kInstanceTexels + 3u, p) : p;
}

// The same between the planes of --clip, times `w`: 1 at the near one, 0 at the far one. Zero and less are clipped, so
// that nothing is seen behind the far plane.
float clipped_depth(float depth, float w) {
  float range = hybrid.far - hybrid.near;
  if (is_orthographic()) return (hybrid.far * w - depth) / range;
  return frame.clip_far < kFar ? hybrid.near * ((hybrid.far * w - depth) / range) : hybrid.near * w;
}

// Clip-space position of the point q / w, relative to the eye; w = 0: infinitely far in the direction of q.
vec4 clip_point(vec3 q, float w) {
  // The inverse of camera_ray(): right, up and forward are at right angles.
  vec2 position = vec2(dot(q, frame.camera_right) / dot(frame.camera_right, frame.camera_right),
                    dot(q, frame.camera_up) / dot(frame.camera_up, frame.camera_up));
  float depth = dot(q, frame.camera_forward);
  // Pixels are sampled in their centres, so that the picture moves against the jitter. Clip space has y downwards.
  vec2 shift = 2.0 * hybrid.jitter / vec2(frame.width, frame.height);
  if (uses_camera_model()) { // the frustum is off the axis: what `depth` shifts, division by it makes a constant
    float divisor = is_orthographic() ? w : depth;
    position -= frame.camera_shift * divisor;
    return vec4(vec2(position.x, -position.y) - shift * divisor, clipped_depth(depth, w), divisor);
  }
  vec2 flipped = vec2(position.x, -position.y);
  return is_orthographic() ? vec4(flipped - shift * w, w - depth / hybrid.far, w)
                           : vec4(flipped - shift * depth, hybrid.near * w, depth);
}

vec4 clip_corner(uint triangle, uint corner, uint instance) {
  return clip_point(corner_position(triangle, corner, instance) - frame.camera_position, 1.0);
}

#endif
