// Planes that shadows fall on. Include kernels/hybrid/shadows/bindings.glsl with BIND_GEOMETRY first.
#ifndef WAVEPATH_PLANAR_GLSL
#define WAVEPATH_PLANAR_GLSL

#include "kernels/base/config.glsl"
#include "kernels/bvh/instance.glsl"
#include "kernels/hybrid/shadows/planar_types.h"

#if defined(BIND_PLANAR_PAIRS) || defined(BIND_RECEIVER_PLANES)
layout(set = 0, binding = kBindPlanarPairs) uniform samplerBuffer planar_pairs;

PlanarPair fetch_planar_pair(uint index) {
  int texel = int(index * kPlanarPairTexels);
  vec4 a = texelFetch(planar_pairs, texel), b = texelFetch(planar_pairs, texel + 1),
       c = texelFetch(planar_pairs, texel + 2);
  return PlanarPair(a.xyz, a.w, b.xyz, b.w, c.x, c.y, floatBitsToUint(c.z), 0u);
}

#endif

float height_above(PlanarPair pair, vec3 position) { return dot(pair.normal, position) + pair.offset; }

// Corner of a triangle, in device world space.
vec3 placed_corner(uint triangle, uint instance, uint corner) {
  vec3 p = texelFetch(triangles, int(triangle * kTriangleTexels + corner)).xyz;
  return has(kFeatureInstances) && frame.root_is_top != 0u ? transform_point(instance * kInstanceTexels + 3u, p) : p;
}

bool is_of_plane(PlanarPair pair, uint triangle, uint instance) {
  float farthest = 0.0;
  for (uint corner = 0u; corner < 3u; ++corner)
    farthest = max(farthest, abs(height_above(pair, placed_corner(triangle, instance, corner))));
  return farthest <= pair.tolerance;
}

#ifdef BIND_RECEIVER_PLANES
// True if the triangle lies in one of the planes that receive shadows, the only ones in the buffer of pairs. Other
// triangles cast.
bool is_receiver(uint triangle, uint instance) {
  uint count = fetch_planar_pair(0u).source; // textureSize() is wrong in vertex shaders of Mesa 22.3
  for (uint i = 0u; i < count; ++i)
    if (is_of_plane(fetch_planar_pair(i), triangle, instance)) return true;
  return false;
}
#endif

#endif
