// Where corners and normals of triangles are at the moment of a path, if they move while the shutter is open: along
// straight lines, from where it opens to where it closes. Include bindings.glsl with BIND_GEOMETRY first.
#ifndef WAVEPATH_MOTION_GLSL
#define WAVEPATH_MOTION_GLSL

#include "kernels/base/config.glsl"
#include "kernels/base/dimensions.glsl"
#include "kernels/base/sampler.glsl"

const bool kMoves = kMotion != 0u;

// Time of the current path: 0 when the shutter opens, 1 when it closes. Frames share their first hits, so that each is
// of one moment, the middle (kernels/hybrid/motion_blur.comp).
float shutter_time = has(kFeatureSharedFirstHit) ? 0.5 : 0.0;

// Sets the time of a path. Must be called before any access to the scene.
void open_shutter(Sampler path_sampler) {
  if (kMoves && !has(kFeatureSharedFirstHit)) shutter_time = sample_2d(path_sampler, kDimensionTime).x;
}

// The corner of a triangle that stands in a texel. Precise: traversal and shading see the same triangle to the last
// bit, so that rounding here is no error of a hit.
vec3 moved(vec3 corner, int texel) {
  if (!kMoves) return corner;
  precise vec3 position = corner + shutter_time * texelFetch(triangles, int(frame.motion_texel) + texel).xyz;
  return position;
}

#endif
