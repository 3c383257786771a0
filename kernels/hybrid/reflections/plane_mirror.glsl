// Where a frame shows a plane mirror. Include bindings.glsl with BIND_GEOMETRY, BIND_SURFACES,
// BIND_HYBRID and BIND_VISIBILITY, and declare `reflection` first.
#ifndef WAVEPATH_PLANE_MIRROR_GLSL
#define WAVEPATH_PLANE_MIRROR_GLSL

#include "kernels/hybrid/hybrid.glsl"
#include "kernels/bvh/known_triangle.glsl"
#include "kernels/surface/surface.glsl"

const float kParallel = 0.9999; // cosine of the normals of one plane

// True if what a ray meets on a triangle, `id` as in kBindVisibility, is a plane mirror.
bool meets_plane_mirror(uvec2 id, vec3 origin, vec3 direction, vec4 plane) {
  if (id.x == kNone) return false;
  Surface surface = fetch_surface(hit_of_triangle(id.x, id.y, origin, direction));
  return abs(dot(plane.xyz, surface.position) + plane.w) <= reflection.tolerance &&
         abs(dot(plane.xyz, surface.geometric_normal)) > kParallel &&
         surface.vertex_normal == surface.geometric_normal;
}

// True if a pixel of the frame shows it.
bool shows_plane_mirror(uvec2 pixel, vec4 plane) {
  vec3 origin, direction;
  hybrid_camera_ray(pixel, origin, direction);
  return meets_plane_mirror(texelFetch(visibility, int(pixel.y * frame.width + pixel.x)).xy, origin, direction, plane);
}

#endif
