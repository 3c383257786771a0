// Point where a ray meets a triangle that it is known to meet, for example because the triangle was rasterized there.
// Include bindings.glsl with BIND_GEOMETRY first.
#ifndef WAVEPATH_KNOWN_TRIANGLE_GLSL
#define WAVEPATH_KNOWN_TRIANGLE_GLSL

#include "kernels/base/config.glsl"
#include "kernels/base/motion.glsl"
#include "kernels/bvh/instance.glsl"
#include "kernels/base/records.glsl"
#include "kernels/bvh/triangle.glsl"

// A ray in world space against a triangle, with the arithmetic of traversal.
Candidate candidate_of_triangle(uint triangle, uint instance, vec3 origin, vec3 direction) {
  if (has(kFeatureInstances) && frame.root_is_top != 0u) {
    uint texel = instance * kInstanceTexels;
    origin = transform_point(texel, origin);
    direction = transform_vector(texel, direction);
  }
  int texel = int(triangle * kTriangleTexels);
  return intersect_triangle(make_traversal_ray(origin, direction), moved(texelFetch(triangles, texel).xyz, texel),
                            moved(texelFetch(triangles, texel + 1).xyz, texel + 1),
                            moved(texelFetch(triangles, texel + 2).xyz, texel + 2));
}

// The hit that traversal would report. Rasterizers place corners on a grid of at best 1/256 pixel, so that at edges the
// exact ray may miss a triangle that covers its pixel; the weights are then moved into it, which moves the hit by as
// little.
Hit hit_of_candidate(uint triangle, uint instance, Candidate candidate) {
  vec3 weights = vec3(1.0 - candidate.b1 - candidate.b2, candidate.b1, candidate.b2);
  if (!candidate.hit && min(weights.x, min(weights.y, weights.z)) < 0.0) {
    weights = max(weights, vec3(0.0)); // one of them is positive: their sum was 1
    weights /= weights.x + weights.y + weights.z;
  }
  return Hit(triangle, instance, weights.y, weights.z);
}

Hit hit_of_triangle(uint triangle, uint instance, vec3 origin, vec3 direction) {
  return hit_of_candidate(triangle, instance, candidate_of_triangle(triangle, instance, origin, direction));
}

#endif
