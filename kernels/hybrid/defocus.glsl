// The spot that a thin lens makes of a pixel: a disc, whose pixels share its light by how much of them it covers.
#ifndef WAVEPATH_DEFOCUS_GLSL
#define WAVEPATH_DEFOCUS_GLSL

#include "kernels/hybrid/reproject.glsl"

layout(set = 0, binding = kFilterLens, std140) uniform LensBlock { DefocusLens lens; };

// Of a disc of `radius` about a pixel's centre: how much of it covers a pixel at that distance. Below half a pixel the
// disc is the pixel alone.
float disc_cover(float distance_, float radius) { return clamp(radius + 0.5 - distance_, 0.0, 1.0); }

#endif
