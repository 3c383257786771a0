// The edges that the passes of SMAA share: of each pixel those to the one above and to the one on its left.
#ifndef WAVEPATH_SMAA_EDGES_GLSL
#define WAVEPATH_SMAA_EDGES_GLSL

const uint kEdgeAbove = 1u, kEdgeLeft = 2u;

layout(set = 0, binding = kFilterEdges, std430) buffer EdgeBlock { uint edges[]; };

#endif
