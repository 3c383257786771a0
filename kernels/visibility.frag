// Writes what a pixel of a hybrid frame sees: the place of the triangle and its instance. Where a surface can be passed through,
// it decides as a traced camera ray of the same pixel and sample does.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_HYBRID
#include "kernels/bindings.glsl"
#include "kernels/hybrid.glsl"
#include "kernels/surface.glsl"

layout(location = 0) flat in uint triangle;
layout(location = 1) flat in uint instance;
layout(location = 0) out uvec2 seen;

bool is_passed_through() {
  uint flags = floatBitsToUint(texelFetch(triangles, int(triangle * kTriangleTexels)).w);
  bool one_sided = has(kFeatureCull) && (flags & kTriangleSingleSided) != 0u;
  bool has_holes = has(kFeatureAlpha) && (flags & kTriangleAlpha) != 0u;
  if (!one_sided && !has_holes) return false;
  uvec2 pixel = uvec2(gl_FragCoord.xy);
  vec3 origin, direction;
  hybrid_camera_ray(pixel, origin, direction);
  Candidate candidate = candidate_of_triangle(triangle, instance, origin, direction);
  if (one_sided && !candidate.front) return true;
  if (!has_holes) return false;
  return is_hole(hit_of_candidate(triangle, instance, candidate), hybrid_sampler(pixel), kHashExtend);
}

void main() {
  // Folds away where a scene has neither, so that depth is tested before shading.
  if (has(kFeatureAlpha | kFeatureCull) && is_passed_through()) discard;
  seen = uvec2(triangle, instance);
}
