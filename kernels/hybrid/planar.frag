// Writes that a pixel is in shadow, where what it shows is of the plane that casters are flattened onto.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_PLANAR_PAIRS
#define BIND_SURFACES
#define BIND_HYBRID
#define BIND_VISIBILITY
#include "kernels/hybrid/bindings.glsl"
#include "kernels/hybrid/shadows/bindings.glsl"
#include "kernels/hybrid/hybrid.glsl"
#include "kernels/bvh/known_triangle.glsl"
#include "kernels/hybrid/shadows/planar.glsl"
#include "kernels/surface/surface.glsl"

layout(location = 0) flat in uint triangle;
layout(location = 1) flat in uint instance;
layout(location = 2) in vec3 position; // position of the caster, device world space
layout(location = 3) in float height;  // height of the caster above the plane
layout(location = 0) out uint in_shadow;

bool is_on_plane(PlanarPair pair, uvec2 pixel) {
  uvec2 seen = texelFetch(visibility, int(pixel.y * frame.width + pixel.x)).xy;
  return seen.x != kNone && is_of_plane(pair, seen.x, seen.y);
}

// MASK and BLEND, decided where the pixel's light passes the surface; unlit surfaces cast no shadow.
bool is_passed_through(PlanarPair pair, uvec2 pixel) {
  if (!has(kFeatureAlpha)) return false;
  uint flags = floatBitsToUint(texelFetch(triangles, int(triangle * kTriangleTexels)).w);
  if ((flags & kTriangleAlpha) == 0u) return false;
  vec3 direction = pair.is_point == 0.0 ? -pair.light : position - pair.light;
  Hit hit = hit_of_triangle(triangle, instance, position - direction, direction);
  return is_hole(hit, hybrid_sampler(pixel), kHashConnect);
}

void main() {
  PlanarPair pair = fetch_planar_pair(wave.first_pixel);
  uvec2 pixel = uvec2(gl_FragCoord.xy);
  // Casters below the plane would cast a false shadow.
  if (height <= pair.tolerance || !is_on_plane(pair, pixel) || is_passed_through(pair, pixel)) discard;
  in_shadow = 1u;
}
