// Light paths, their vertices, and connections between them and camera paths.
#ifndef WAVEPATH_BIDIRECTIONAL_TYPES_H
#define WAVEPATH_BIDIRECTIONAL_TYPES_H

#include "kernels/base/frame_types.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

GPU_CONSTANT uint kBindBidirectional = 32u;     // uniform BidirectionalFrame
GPU_CONSTANT uint kBindPathWeights = 33u;       // storage PathWeights[], one a slot
GPU_CONSTANT uint kBindLightVertices = 34u;     // storage LightVertex[]: vertex k of a slot at k * slot_count + slot
GPU_CONSTANT uint kBindLightVertexTexels = 35u; // texels RGBA32UI
GPU_CONSTANT uint kBindLightCounts = 36u;       // storage uint[], one a slot: light vertices that it has
GPU_CONSTANT uint kBindConnections = 37u;       // storage Connection[], one a slot
GPU_CONSTANT uint kBindConnectionTexels = 38u;  // texels RGBA32UI
GPU_CONSTANT uint kBindConnectionQueue = 39u;   // storage ConnectionQueue

// Ways to complete a path, by where its ends meet: bits of BidirectionalFrame::techniques.
GPU_CONSTANT uint kTechniqueHit = 1u << 0;     // a camera path meets the light by chance (s = 0)
GPU_CONSTANT uint kTechniqueLight = 1u << 1;   // it is connected to a point on a light (s = 1)
GPU_CONSTANT uint kTechniqueConnect = 1u << 2; // it is connected to a vertex of a light path (s > 1)
GPU_CONSTANT uint kTechniqueSplat = 1u << 3;   // a light path is connected to the camera (t = 1)
GPU_CONSTANT uint kTechniqueMerge = 1u << 4;   // it ends near a vertex of a light path (see photon_types.h)
GPU_CONSTANT uint kTechniquesAll = 31u;

struct BidirectionalFrame {
  vec3 scene_centre; // centre of a sphere around the geometry
  float scene_radius;
  float pixel_area;  // orthographic: of a pixel; perspective: of a pixel at unit distance along the view axis;
                     // panorama: in radians squared
  float light_paths; // number of light paths for one sample of all pixels, of one eye
  uint techniques;
  uint lamps_in_bodies; // 1: the box of a body holds a lamp
};
GPU_CHECK(sizeof(BidirectionalFrame) == 32);

// Sums of the weights of other techniques relative to the one at hand (Georgiev 2012), up to the latest vertex.
struct PathWeights {
  float connect; // sum for connecting the latest vertex to the one before it (dVCM of Georgiev 2012)
  float others;  // sum for all earlier connections, over the density of the direction back from the latest vertex (dVC)
};
GPU_CHECK(sizeof(PathWeights) == 8);

// A light vertex: where light arrived. Its surface is fetched again from the hit.
struct LightVertex {
  vec3 direction; // back along the light path, unit length
  uint bounce;    // surfaces that the light has met, this one included
  vec3 light;     // arriving, over the density of the light path and the cosine to the surface
  float connect;  // PathWeights
  uint triangle;  // Hit
  uint instance;
  float b1;
  float b2;
  float others;
  uint outside; // the body that its surface borders on (kLobeNested), kNone: the open
  uint group;   // of lights (kFeatureLightGroups)
  uint pad0;
};
GPU_CHECK(sizeof(LightVertex) == 64);

// A ray between a camera path, or the camera, and a light vertex. It hides its contribution if it is blocked.
struct Connection {
  vec3 origin;
  uint slot;
  vec3 direction; // vector to the light vertex, not normalized: t in (0,1)
  uint triangle;  // triangle of the light vertex
  vec3 contribution;
  uint instance; // instance of that triangle
  uint pixel;    // pixel, in tile order, that gains the light; unused if the slot's path gains it
  uint group;    // of lights (kFeatureLightGroups)
  uint in_body;  // 1: it runs within a body, which displaces the volume (kFeatureVoxels)
  uint pad0;
};
GPU_CHECK(sizeof(Connection) == 64);

struct ConnectionQueue {
  uint count;
  uint groups[3]; // indirect dispatch size
};
GPU_CHECK(sizeof(ConnectionQueue) == 16);

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
