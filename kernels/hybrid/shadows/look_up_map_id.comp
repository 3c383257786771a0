// A map of triangles instead of depths (after Hourcade and Nicolas 1985): what the light sees at a texel is the
// receiver itself, or it is in the way. Nothing needs a bias; triangles that share a corner count as one, so that a
// convex body does not shade itself, and light leaks along the edges that bodies share.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_SHADOW_IDS
#include "kernels/hybrid/shadows/look_up.glsl"

bool share_corner(uint a, uint b) {
  int first = int(a * kTriangleTexels), second = int(b * kTriangleTexels);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (texelFetch(triangles, first + i).xyz == texelFetch(triangles, second + j).xyz) return true;
  return false;
}

float lit_fraction(Receiver r) {
  uvec2 seen = texelFetch(shadow_ids, map_texel(r.view, ivec2(floor(r.map_position)))).xy;
  if (seen.x == kNone || seen == uvec2(r.hit.triangle, r.hit.instance)) return 1.0;
  return seen.y == r.hit.instance && share_corner(seen.x, r.hit.triangle) ? 1.0 : 0.0;
}
