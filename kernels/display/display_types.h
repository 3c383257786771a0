// Constants of display.comp, shared with the host; every member is a word, so that all layouts agree.
#ifndef WAVEPATH_DISPLAY_TYPES_H
#define WAVEPATH_DISPLAY_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// Storage uint[]: what a window shows, a word of bytes R G B A a pixel (or B G R A), row-major.
GPU_CONSTANT uint kBindScreen = 40u;

GPU_CONSTANT uint kBindFilmAovWords = 47u; // texels RGBA32UI: the same memory as kBindFilmAovs

// Quantities of the film that can be shown.
GPU_CONSTANT uint kShowColor = 0u, kShowAlbedo = 1u, kShowNormal = 2u, kShowDepth = 3u, kShowPosition = 4u,
                  kShowDirect = 5u, kShowIndirect = 6u, kShowEmission = 7u, kShowSamples = 8u, kShowVariance = 9u,
                  kShowError = 10u, kShowOcclusion = 12u, kShowRoughness = 13u, kShowMetallic = 14u,
                  kShowTriangles = 15u, kShowInstances = 16u, kShowMaterials = 17u; // 11: drawn by the host
GPU_CONSTANT uint kTonemapNone = 0u, kTonemapAces = 1u, kTonemapAgx = 2u, kTonemapNeutral = 3u;

// Radiance after exposure of the squares behind what is transparent, 8 pixels wide.
GPU_CONSTANT float kDarkSquare = 0.15f, kBrightSquare = 0.25f;

// Push constants of display.comp, which has a binding set of its own.
struct DisplayJob {
  uint width; // of the screen
  uint height;
  uint first; // screen pixel that the dispatch begins with
  uint film_width;
  uint film_height;
  uint first_film_pixel; // in tile order, of the band that is bound
  uint film_pixel_count; // number of its pixels
  uint probes;           // as Frame has it
  uint first_probe;      // block of the band's first probe
  uint seed;             // seed of the render
  uint shown;
  uint tonemap;
  uint bgra;         // order of the bytes: 1 = B G R A
  uint splats;       // 1: the film has some
  float gain;        // factor of radiance
  float range;       // value that is shown brightest, for quantities other than radiance
  uint first_column; // first column of the screen that is drawn
  uint groups;       // number of groups of lights, which are mixed; 0 = the picture is shown as it is
  uint gains[8];     // their gains: two halves a word, packHalf2x16
  uint covers;       // 1: the film has sums of transparency, and squares are shown behind what is transparent
};

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
