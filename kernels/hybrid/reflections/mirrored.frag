// Writes what a pixel sees in a plane mirror: the index of the triangle and its instance. What is behind the mirror,
// and the mirror itself, is cut away point by point, since clip distances are an optional feature. The camera is that
// of the frame, mirrored once or twice. Push constant: first_sample = the picture, bounce = that of mirrored rays.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_HYBRID
#include "kernels/hybrid/bindings.glsl"
#include "kernels/hybrid/hybrid.glsl"
#include "kernels/hybrid/reflections/reflection_types.h"
#include "kernels/bvh/known_triangle.glsl"
#include "kernels/surface/surface.glsl"

layout(set = 0, binding = kBindReflectionFrame, std140) uniform ReflectionFrameBlock { ReflectionFrame reflection; };

layout(location = 0) flat in uint triangle;
layout(location = 1) flat in uint instance;
layout(location = 2) flat in uint hidden_sides; // 1: the clockwise one, 2: the other
layout(location = 0) out uvec2 seen;

// A mirrored picture turns triangles over, one that is mirrored again turns them back.
bool is_hidden() {
  bool turned = dot(cross(frame.camera_right, frame.camera_up), frame.camera_forward) > 0.0;
  return CULLS_ALL_BACKS && (hidden_sides & (gl_FrontFacing != turned ? 2u : 1u)) != 0u;
}

void main() {
  if (is_hidden()) discard;
  uvec2 pixel = uvec2(gl_FragCoord.xy);
  vec3 origin, direction;
  hybrid_camera_ray(pixel, origin, direction);
  Hit hit = hit_of_triangle(triangle, instance, origin, direction);
  vec4 plane = reflection.mirrors[wave.first_sample];
  if (dot(plane.xyz, fetch_surface(hit).position) + plane.w <= reflection.tolerance) discard;
  uint flags = floatBitsToUint(texelFetch(triangles, int(triangle * kTriangleTexels)).w);
  if (has(kFeatureAlpha) && (flags & kTriangleAlpha) != 0u && is_hole(hit, hybrid_sampler(pixel), kHashExtend)) discard;
  seen = uvec2(triangle, instance);
}
