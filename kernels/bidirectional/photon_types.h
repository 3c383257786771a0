// Photons: the ends of light paths that nothing but mirrors and smooth glass has scattered, and the grid that finds
// those near a point. Camera paths that have met nothing but mirrors and smooth glass either end there
// (kTechniqueMerge).
#ifndef WAVEPATH_PHOTON_TYPES_H
#define WAVEPATH_PHOTON_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

GPU_CONSTANT uint kBindPhotonFrame = 40u;      // uniform PhotonFrame
GPU_CONSTANT uint kBindPhotons = 42u;          // storage Photon[], path_count for each replicate
GPU_CONSTANT uint kBindPhotonTexels = 43u;     // texels RGBA32UI
GPU_CONSTANT uint kBindPhotonCells = 44u;      // storage PhotonCell[], cell_count
GPU_CONSTANT uint kBindPhotonCellTexels = 45u; // texels RG32UI
GPU_CONSTANT uint kBindMergeWeights = 46u;     // storage float[], one a slot: see merging.glsl

// The map in use. Cells are cubes of twice the radius, found by a hash; cells that share an index share its list.
struct PhotonFrame {
  uint path_count; // light paths of each replicate
  uint cell_count; // a power of two
  float radius;
  // Pi radius^2 path_count: of photons that are found from a point, over the density per area of one path.
  float density;
  float cells_per_metre;
  uint pad0;
  uint pad1;
  uint pad2;
};
GPU_CHECK(sizeof(PhotonFrame) == 32);

struct Photon {
  vec3 position;
  uint normal;    // geometric normal, packSnorm4x8 | group of lights << kPhotonGroupShift (kFeatureLightGroups)
  vec3 direction; // back along the light path, unit length
  uint link;  // surfaces met, this one included, << kPhotonBounceShift | index of the next photon of the cell + 1; 0 =
              // none
  vec3 light; // arriving, over the density of the light path and the cosine to the surface
  float others; // PathWeights
};
GPU_CHECK(sizeof(Photon) == 48);
GPU_CONSTANT uint kPhotonBounceShift = 20u, kPhotonIndexMask = (1u << kPhotonBounceShift) - 1u;
GPU_CONSTANT uint kPhotonGroupShift = 24u; // above the three components of the normal
GPU_CONSTANT uint kMostPhotonBounces = 4095u;

struct PhotonCell {
  uint count; // number of photons that arrived
  uint first; // index + 1 of the first photon that was kept
};
GPU_CHECK(sizeof(PhotonCell) == 8);

// Where more photons share a cell, so many are kept on average, each by chance and brighter: it bounds the work for a
// point, and keeps below 65,535 trips of loops, after which Mesa 22.3 ends them all.
GPU_CONSTANT uint kMostInCell = 512u;

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
