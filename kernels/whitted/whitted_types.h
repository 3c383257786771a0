// Types of the kernels of Whitted's ray tracer.
#ifndef WAVEPATH_WHITTED_TYPES_H
#define WAVEPATH_WHITTED_TYPES_H

#include "kernels/base/frame_types.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

GPU_CONSTANT uint kBindWhitted = 32u;      // uniform WhittedFrame
GPU_CONSTANT uint kBindWhittedNodes = 33u; // storage WhittedNode[]

// A camera ray's tree has so many nodes for rays at once. Where it would need more, one of two branches is chosen at
// random.
GPU_CONSTANT uint kTreeWidth = 8u;

// Shadow rays of one dispatch: Mesa 22.3 ends all loops of an invocation silently after 65,535 trips together, and one
// ray takes hundreds.
GPU_CONSTANT uint kLightsAtOnce = 16u;

// Of emissive triangles, no more than so many get a shadow ray from a surface; where there are more, they are picked by
// power. A mesh that shines may have thousands.
GPU_CONSTANT uint kMostTriangleRays = 16u;

struct WhittedFrame {
  vec3 ambient;       // radiance that stands for all light that reaches a surface after another one
  float cutoff;       // rays of a smaller weight are not followed
  uint width;         // nodes of a tree: kTreeWidth, or 1 where one branch is always chosen
  uint triangles;     // emissive ones, which come first in the list of lights
  uint triangle_rays; // shadow rays of a surface to them
  uint shadow_rays;   // shadow rays to all lights, a sky of one colour included
};
GPU_CHECK(sizeof(WhittedFrame) == 32);

// A ray of the tree, and where it has hit. Node p of a sample is entry p * (samples of the wave) + slot.
struct WhittedNode {
  vec3 origin;
  uint width; // nodes that its descendants may take, from its own on; 0 = no ray is here
  vec3 direction;
  uint medium;
  vec3 weight; // fraction of its radiance that reaches the eye
  uint path;   // names the way of reflections and refractions that led here
  Hit hit;
  vec3 hit_weight; // fraction of what the surface hit sends towards the origin that reaches the eye
  uint hit_medium; // medium that the ray arrived in
  vec3 arrival;    // direction of the ray that hit
  uint hit_path;
  uint depth;     // depth of the ray; kNone if there was none
  uint hit_depth; // depth of the ray whose hit lights may light; kNone if there was none
  uint pad0;
  uint pad1;
};
GPU_CHECK(sizeof(WhittedNode) == 112);

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
