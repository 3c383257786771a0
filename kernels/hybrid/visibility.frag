// Writes what a pixel of a hybrid frame sees: the index of the triangle and its instance. Where a surface can be passed
// through, it decides as a traced camera ray of the same pixel and sample does, or as
// --transparency says.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_HYBRID
#include "kernels/hybrid/bindings.glsl"
#include "kernels/hybrid/seen_through.glsl"
#include "kernels/bvh/known_triangle.glsl"

layout(location = 0) flat in uint triangle;
layout(location = 1) flat in uint instance;
layout(location = 2) flat in uint hidden_sides; // 1: the clockwise one, 2: the other
layout(location = 0) out uvec2 seen;

// Which side is seen is known without the ray: it is the same for the whole triangle, but for those seen edge-on.
bool is_hidden() { return CULLS_BACKS && (hidden_sides & (gl_FrontFacing ? 2u : 1u)) != 0u; }

bool is_passed_through() {
  if (!has(kFeatureAlpha)) return false;
  uint flags = floatBitsToUint(texelFetch(triangles, int(triangle * kTriangleTexels)).w);
  if (is_layer_of_glass(flags)) return true;
  if ((flags & kTriangleAlpha) == 0u) return false;
  uvec2 pixel = uvec2(gl_FragCoord.xy);
  vec3 origin, direction;
  hybrid_camera_ray(pixel, origin, direction);
  Hit hit = hit_of_triangle(triangle, instance, origin, direction);
  return is_seen_through(hit, pixel);
}

void main() {
  // Folds away where a scene has neither, so that depth is tested before shading.
  if ((has(kFeatureAlpha) || CULLS_BACKS) && (is_hidden() || is_passed_through())) discard;
  seen = uvec2(triangle, instance);
}
