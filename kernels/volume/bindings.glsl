// Bindings of the volume: VolumeFrame, cells and bricks, voxels.
#ifndef WAVEPATH_VOLUME_BINDINGS_GLSL
#define WAVEPATH_VOLUME_BINDINGS_GLSL

#include "kernels/volume/voxel_types.h"

layout(set = 0, binding = kBindVolume, std140) uniform VolumeBlock { VolumeFrame volume; };
layout(set = 0, binding = kBindVolumeGrid) uniform usamplerBuffer volume_grid;
layout(set = 0, binding = kBindVoxels) uniform samplerBuffer volume_voxels;

#endif
