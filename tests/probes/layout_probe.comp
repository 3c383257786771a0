// Declares every struct that host and kernels share, so that its SPIR-V says where the shader compiler put each member.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernels/bidirectional/bidirectional_types.h"
#include "kernels/bidirectional/photon_types.h"
#include "kernels/film/cover_types.h"
#include "kernels/film/film_types.h"
#include "kernels/base/frame_types.h"
#include "kernels/hybrid/filter_types.h"
#include "kernels/hybrid/hybrid_types.h"
#include "kernels/base/light_tree_types.h"
#include "kernels/path/path_types.h"
#include "kernels/base/scene_types.h"
#include "kernels/hybrid/reflections/reflection_types.h"
#include "kernels/hybrid/shading/shading_types.h"
#include "kernels/hybrid/shadows/planar_types.h"
#include "kernels/hybrid/shadows/shadow_types.h"
#include "kernels/volume/voxel_types.h"
#include "kernels/radiosity/radiosity_types.h"
#include "kernels/whitted/whitted_types.h"

layout(local_size_x = 1) in;
layout(push_constant) uniform Push { Wave wave; };
layout(set = 0, binding = 0, std140) uniform FrameBlock { Frame frame; };
layout(set = 0, binding = 1, std430) buffer Triangles { Triangle triangles[]; };
layout(set = 0, binding = 2, std430) buffer Instances { Instance instances[]; };
layout(set = 0, binding = 3, std430) buffer Materials { Material materials[]; };
layout(set = 0, binding = 38, std430) buffer Layers { MaterialLayers layers[]; };
layout(set = 0, binding = 4, std430) buffer Textures { Texture textures[]; };
layout(set = 0, binding = 5, std430) buffer Lights { Light lights[]; };
layout(set = 0, binding = 29, std430) buffer LightClusters { LightCluster light_clusters[]; };
layout(set = 0, binding = 30, std430) buffer LightTreeChildren { LightTreeChild light_tree_children[]; };
layout(set = 0, binding = 31, std430) buffer LightTreeNodes { LightTreeNode light_tree_nodes[]; };
layout(set = 0, binding = 6, std430) buffer Paths { PathState paths[]; };
layout(set = 0, binding = 7, std430) buffer Rays { Ray rays[]; };
layout(set = 0, binding = 8, std430) buffer Hits { Hit hits[]; };
layout(set = 0, binding = 9, std430) buffer ShadowRays { ShadowRay shadow_rays[]; };
layout(set = 0, binding = 10, std430) buffer QueueBlocks { Queues queues[]; };
layout(set = 0, binding = 28, std430) buffer WhittedNodes { WhittedNode whitted_nodes[]; };
layout(set = 0, binding = 27, std430) buffer WhittedFrames { WhittedFrame whitted_frames[]; };
layout(set = 0, binding = 50, std430) buffer PatchBlocks { Patch patches[]; };
layout(set = 0, binding = 51, std430) buffer PatchSurfaces { PatchSurface patch_surfaces[]; };
layout(set = 0, binding = 52, std430) buffer ShotBlocks { ShotBlock shot_blocks[]; };
layout(set = 0, binding = 56, std430) buffer LinkBlocks { LinkBlock link_blocks[]; };
layout(set = 0, binding = 53, std430) buffer SeenPoints { SeenPoint seen_points[]; };
layout(set = 0, binding = 26, std430) buffer CounterBlocks { Counters counters[]; };
layout(set = 0, binding = 11, std430) buffer Film { FilmPixel film[]; };
layout(set = 0, binding = 21, std430) buffer Sums { ExactSum sums[]; };
layout(set = 0, binding = 12, std430) buffer Aovs { PathAovs aovs[]; };
layout(set = 0, binding = 13, std430) buffer FilmAovBlocks { FilmAovs film_aovs[]; };
layout(set = 0, binding = 24, std140) uniform HybridBlock { HybridFrame hybrid; };
layout(set = 0, binding = 25, std430) buffer Gbuffer { GbufferPixel gbuffer[]; };
layout(set = 0, binding = 22, std430) buffer Reprojections { Reprojection reprojections[]; };
layout(set = 0, binding = 29, std430) buffer GuideRecords { GuideRecord guide_records[]; };
layout(set = 0, binding = 30, std430) buffer GuideNodes { GuideNode guide_nodes[]; };
layout(set = 0, binding = 54, std430) buffer DefocusLenses { DefocusLens defocus_lenses[]; };
layout(set = 0, binding = 23, std430) buffer Bands { FilterBand filter_bands[]; };

layout(set = 0, binding = 29, std140) uniform BidirectionalBlock { BidirectionalFrame bidirectional; };
layout(set = 0, binding = 30, std430) buffer Weights { PathWeights weights[]; };
layout(set = 0, binding = 31, std430) buffer LightVertices { LightVertex light_vertices[]; };
layout(set = 0, binding = 32, std430) buffer Connections { Connection connections[]; };
layout(set = 0, binding = 33, std430) buffer ConnectionQueues { ConnectionQueue connection_queues[]; };
layout(set = 0, binding = 44, std430) buffer PathCovers { PathCover path_covers[]; };
layout(set = 0, binding = 45, std430) buffer FilmCovers { FilmCover film_covers[]; };
layout(set = 0, binding = 34, std430) buffer Splats { SplatPixel splats[]; };
layout(set = 0, binding = 35, std140) uniform PhotonFrameBlock { PhotonFrame photon_frame; };
layout(set = 0, binding = 36, std430) buffer Photons { Photon photons[]; };
layout(set = 0, binding = 37, std430) buffer PhotonCells { PhotonCell photon_cells[]; };
layout(set = 0, binding = 39, std430) buffer ShadowViews { ShadowView shadow_views[]; };
layout(set = 0, binding = 40, std430) buffer ShadowFrames { ShadowFrame shadow_frames[]; };
layout(set = 0, binding = 41, std430) buffer ShadowCountBlocks { ShadowCounts shadow_counts[]; };
layout(set = 0, binding = 42, std430) buffer ShadingFrames { ShadingFrame shading_frames[]; };
layout(set = 0, binding = 46, std430) buffer VolumeFrames { VolumeFrame volume_frames[]; };
layout(set = 0, binding = 47, std430) buffer VoxelBoxes { VoxelBox voxel_boxes[]; };
layout(set = 0, binding = 43, std430) buffer PlanarPairs { PlanarPair planar_pairs[]; };

layout(set = 0, binding = 48, std430) buffer ReflectionFrames { ReflectionFrame reflection_frames[]; };
layout(set = 0, binding = 49, std430) buffer NestedRays { NestedRay nested_rays[]; };

void main() {}
