// The light tree on the device: a binary tree over the lights that have a location, as records of 32 bytes.
#ifndef WAVEPATH_LIGHT_TREE_TYPES_H
#define WAVEPATH_LIGHT_TREE_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// Texels RGBA32UI: root and nodes; branches and cluster by light; branches by cluster.
GPU_CONSTANT uint kBindLightTree = 56u;

// A link is the record of an inner node, or with kLightLeaf the index of a light.
GPU_CONSTANT uint kLightLeaf = 0x80000000u;
GPU_CONSTANT uint kLightTwoSided = 0x40000000u;    // some light below shines to both sides
GPU_CONSTANT uint kLightClusterRoot = 0x20000000u; // root of a cluster of trained selection
GPU_CONSTANT uint kLightIndexMask = kLightClusterRoot - 1u;

GPU_CONSTANT uint kLightRecordTexels = 2u; // RGBA32UI

// State of a walk down the tree; record 0 holds the state at the root.
struct LightCluster {
  vec3 lo; // box
  uint link;
  vec3 hi;
  uint depth; // choices made so far
};
GPU_CHECK(sizeof(LightCluster) == 16 * kLightRecordTexels);

// One of the two subtrees of a node. Values are rounded so that no light lies outside. Bytes of the words, lowest
// first:
struct LightTreeChild {
  uint box0;     // lo.x, lo.y, lo.z, hi.x in 1/255 of the node's own box, which the walk carries along
  uint box1;     // hi.y, hi.z; axis of the cone, octahedral
  uint emission; // 16 bits: peak intensity, see light_intensity(); sines of half of theta_o and half of theta_e
  uint link;
};
GPU_CHECK(sizeof(LightTreeChild) == 16);

struct LightTreeNode {
  LightTreeChild child[2];
};
GPU_CHECK(sizeof(LightTreeNode) == 16 * kLightRecordTexels);

// Exponent of the smallest intensity that 16 bits hold, six of them exponent, in units of the whole tree's.
GPU_CONSTANT uint kLeastIntensityExponent = 127u - 62u;

// ---- trained selection ----------------------------------------------------------------------------------------------
// Every cell of space, by hash, has probabilities of clusters of lights: subtrees of the light tree, the environment,
// all directional lights, and the whole tree, which is chosen often enough that no light is left out.
GPU_CONSTANT uint kBindLightCells = 57u; // texels R32UI: by cell and cluster the end of its interval of the integers
// Storage uint[] (kFeatureTraining), see host/integrators/path/cell_histograms.h.
GPU_CONSTANT uint kBindLightSums = 58u;
GPU_CONSTANT uint kLightCells = 1u << 14;
GPU_CONSTANT uint kLightClusters = 64u;
GPU_CONSTANT uint kSubtreeClusters = 61u;
GPU_CONSTANT uint kEnvironmentCluster = 61u, kDirectionalCluster = 62u, kTreeCluster = 63u;
GPU_CONSTANT uint kLightCellShift = 2u; // a cell is a quarter to an eighth as wide as it is far

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
