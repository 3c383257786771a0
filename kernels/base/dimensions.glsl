// Allocation of pairs of random numbers. Bounce b uses kDimensionsPerBounce pairs from bounce_dimension(b) on, whether
// or not a scene needs them all, so that leaving features out changes no number.
#ifndef WAVEPATH_DIMENSIONS_GLSL
#define WAVEPATH_DIMENSIONS_GLSL

const uint kDimensionFilter = 0u;
const uint kDimensionsPerBounce = 3u;

const uint kDimensionDirection = 0u; // scattered ray: lobe, and direction in it
const uint kDimensionChoice = 1u;    // x: reflected or transmitted, y: Russian roulette
const uint kDimensionLight = 2u;     // light sample: the light, and the point on it

// Point on the camera's lens; and point on the lens from which a light vertex is seen. Both lie beyond the dimensions
// of any bounce, so that a lens changes no other number.
const uint kDimensionLens = 0x80000000u;
// Directions towards the sky besides the scattered ray, two pairs for each bounce: the direction; x: reflected or
// transmitted.
const uint kDimensionSky = 0x20000000u;
// x: of the lobe of the second vertex that sends light to neighbours (path/reuse.glsl).
const uint kDimensionReuse = 0x10000000u;
// x: optical depth of the first collision with the volume, y: what happens there. One pair for each bounce.
const uint kDimensionVolume = 0x08000000u;
// x: of the moment at which a path sees the scene.
const uint kDimensionTime = 0x40000000u;

// Occlusion rays. Hybrid paths end before they could need these for another bounce.
const uint kDimensionOcclusion = 1u + kDimensionsPerBounce;
const uint kDimensionOcclusionDistance = kDimensionOcclusion + 1u; // x: of a point of SSAO

uint bounce_dimension(uint bounce) { return 1u + bounce * kDimensionsPerBounce; }

// Keys of the hashed numbers for stochastic alpha: occlusion rays draw others than the path's own rays.
const uint kHashExtend = 0u;
const uint kHashConnect = 1u;
uint alpha_key(uint bounce, uint kind) { return 2u * bounce + kind; }

#endif
