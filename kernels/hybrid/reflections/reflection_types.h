// Types of the kernels that find what mirrors in a hybrid frame show of lit surfaces (--reflections).
#ifndef WAVEPATH_REFLECTION_TYPES_H
#define WAVEPATH_REFLECTION_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

GPU_CONSTANT uint kBindReflectionFrame = 132u;  // uniform ReflectionFrame
GPU_CONSTANT uint kBindReflectionCounts = 133u; // storage uint[kReflectionCounts]: totals of all frames, see below

// Texels RG32UI, one a pixel: what the frame shows in one plane mirror, as kBindVisibility.
GPU_CONSTANT uint kBindMirrorPicture = 134u;
// Storage uvec2[], one a pixel: what it shows in its own mirror; kNone and kNoMirror where it shows none. Where mirrors
// show mirrors, as many follow: what the mirror in the mirror shows.
GPU_CONSTANT uint kBindMirrorIds = 135u;
GPU_CONSTANT uint kBindNearness = 136u; // storage float[]: levels of a pyramid over the picture, the finest one first
GPU_CONSTANT uint kBindReflectionMap = 137u; // storage vec4[], one a texel: radiance, unused
// Storage uint[4], of which the first is the number of what follows, NestedRay[]: rays of mirrors that mirrors show.
GPU_CONSTANT uint kBindNestedRays = 163u;

GPU_CONSTANT uint kMostMirrors = 4u; // planes
// What each of them shows, and what it shows of each other one.
GPU_CONSTANT uint kMostPictures = kMostMirrors * kMostMirrors;
GPU_CONSTANT uint kNoMirror = 0xfffffffeu;

// Kinds of maps: faces of a cube; one face, as a mirrored ball shows it; faces of a cube that show the sides of a box.
GPU_CONSTANT uint kMapCube = 0u;
GPU_CONSTANT uint kMapBall = 1u;
GPU_CONSTANT uint kMapBox = 2u;

// The bounce that mirrored rays are counted as: neither that of camera rays, which may see less of single-sided
// surfaces, nor odd, since shading takes first hits from the first half of the queue.
GPU_CONSTANT uint kMirroredBounce = 2u;

// The settings of a technique.
struct ReflectionFrame {
  vec3 centre;     // of the reflection map, device world
  float threshold; // least reflectance at normal incidence, in the brightest channel, of surfaces that are mirrors
  vec3 box_low;    // box whose sides the map shows (kMapBox), device world
  uint map_kind;
  vec3 box_high;
  uint map_side;   // texels along a side of each face
  vec3 axis;       // direction from which the ball of a map is seen (kMapBall)
  float reach;     // metres that a mirrored ray goes in screen space
  float thickness; // metres of all surfaces in screen space
  float tolerance; // metres up to which a point lies in a plane mirror
  uint pad0;
  uint pad1;
  // Planes of pictures in mirrors: unit normal, offset. Normals point towards the eye or, of mirrors in mirrors,
  // towards the eye as the first mirror shows it.
  vec4 mirrors[kMostPictures];
};
GPU_CHECK(sizeof(ReflectionFrame) == 80 + 16 * kMostPictures);

// The ray of a mirror that a mirror shows.
struct NestedRay {
  vec3 origin;
  uint slot;
  vec3 direction;
  uint pad0;
  vec3 weight; // light that gets to the eye for light that comes along the ray
  uint pad1;
};
GPU_CHECK(sizeof(NestedRay) == 48);

// Values of a wave's `bounce` for reflect.comp and reflect_nested.comp: the facets of mirrors that are not quite smooth
// are drawn at random, or all are taken to lie in the surface.
GPU_CONSTANT uint kMirrorsDraw = 0u;
GPU_CONSTANT uint kMirrorsIdeal = 1u;

// 64-bit totals in two words each, low word first.
GPU_CONSTANT uint kCountAsked = 0u;    // samples of pixels that show a mirror, and again where that shows another one
GPU_CONSTANT uint kCountAnswered = 2u; // those of them for which the technique knows what the mirror shows
GPU_CONSTANT uint kReflectionCounts = 4u;

// Mirrors are smoother than this; rougher surfaces show lamps and environment alone. The same as where filters keep
// smooth metal apart (resolve.comp).
GPU_CONSTANT float kMirrorRoughness = 0.3f;

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
