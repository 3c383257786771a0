// A volume on the device: voxels in bricks, and cells that bound them, in which rays take their steps.
#ifndef WAVEPATH_VOXEL_TYPES_H
#define WAVEPATH_VOXEL_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// Bindings of kernels with kFeatureVoxels. No uniform block for VolumeFrame: lavapipe (Mesa 22.3) crashed where it put
// values of one into the code of a kernel.
GPU_CONSTANT uint kBindVolume = 128u; // texels RGBA32UI: VolumeFrame
// Texels RG32UI: by cell its largest and smallest density, as floats (cells()); by brick of a grid where its voxels
// begin, counted in bricks, or kNone and its one value as a float.
GPU_CONSTANT uint kBindVolumeGrid = 129u;
// Texels R32F: voxels by bricks, x slowest, z fastest; behind them the colours of black bodies, three floats each.
GPU_CONSTANT uint kBindVoxels = 130u;

GPU_CONSTANT uint kBrickShift = 3u; // log2 of the voxels along an edge of a brick
GPU_CONSTANT uint kBrickWords = 512u;

// Colours of black bodies: entry i is that of kLowestKelvin * 2^(i / kKelvinSteps). Cooler ones are dark.
GPU_CONSTANT float kLowestKelvin = 100.0f;
GPU_CONSTANT uint kKelvinSteps = 64u, kKelvins = 10u * kKelvinSteps + 1u;

// Places of a grid's bricks. A voxel outside of the box has the value 0.
struct VoxelBox {
  ivec3 first; // coordinates of the first voxel
  uint texel;  // of the first brick in kBindVolumeGrid
  uvec3 bricks;
  uint pad;
};

// Texels of its parts, and their number.
GPU_CONSTANT uint kVolumeCellsFromWorld = 0u, kVolumeTemperatureFromCells = 3u, kVolumeFirstVoxel = 6u,
                  kVolumeDensity = 7u, kVolumeTemperature = 9u, kVolumeCells = 11u, kVolumeScattering = 12u,
                  kVolumeAbsorption = 13u, kVolumeFire = 14u, kVolumeTexels = 15u;

// Three spaces: the world of the device, in metres; cells, whose unit is the edge of one, and whose box the cells fill;
// and the voxels of a grid.
struct VolumeFrame {
  vec4 cells_from_world[3];       // rows of 3x4 matrices
  vec4 temperature_from_cells[3]; // to voxels
  vec3 first_voxel;               // of density, at the origin of the cells
  float cell_side;                // in voxels of density
  VoxelBox density;
  VoxelBox temperature;
  uvec3 cells;      // number along x, y, z
  uint first_cell;  // texel in kBindVolumeGrid
  vec3 scattering;  // 1/m, where the density is 1
  float extinction; // the largest of scattering + absorption among the channels
  vec3 absorption;
  float anisotropy;                  // g of Henyey and Greenstein
  float emission;                    // factor on the radiance of black bodies
  float kelvin_scale, kelvin_offset; // kelvin = scale * (value - offset)
  uint first_kelvin;                 // word of kBindVoxels where their colours begin
};
GPU_CHECK(sizeof(VolumeFrame) == 16 * kVolumeTexels);

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
