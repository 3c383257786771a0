// Common code of the kernels of Whitted's ray tracer (Whitted, "An Improved Illumination Model for Shaded Display",
// CACM 23(6), 1980).
//
// At every surface: emission, a shadow ray to every light (of very many emissive triangles, to some), the ambient term;
// smooth metal and glass send reflected and refracted rays, weighted by Fresnel's equations. What that finds is all
// light of paths with at most one scattering that is not a mirror's or a smooth interface's; a light with an extent is
// sampled at one point a ray, so that its shadows are soft. Rough lobes reflect lights alone.
//
// Every node of a tree belongs to one lane, and sums what its rays bring into its own path state; gathering adds the
// nodes up.
#ifndef WAVEPATH_WHITTED_GLSL
#define WAVEPATH_WHITTED_GLSL

#include "kernels/base/dimensions.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/whitted/whitted_types.h"

layout(set = 0, binding = kBindWhitted, std140) uniform WhittedBlock { WhittedFrame whitted; };
layout(set = 0, binding = kBindWhittedNodes, std430) buffer WhittedNodeBlock { WhittedNode nodes_of_trees[]; };

// First of the random numbers of a ray: two pairs for each shadow ray, one for the choice of a branch. They go by the
// node in the tree, so that a branch that is cut off changes none of the others.
uint node_dimension(uint path) { return 1u + path * (whitted.shadow_rays + 1u); }

// Adds to a total of 64 bits.
#define COUNT(total, n)                                                      \
  {                                                                          \
    uint before_ = atomicAdd(total[0], n);                                   \
    if (before_ + n < before_) atomicAdd(total[1], 1u);                      \
  }

#endif
