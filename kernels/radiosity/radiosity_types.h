// Types of the kernels of radiosity: patches, shots and points that cameras see.
#ifndef WAVEPATH_RADIOSITY_TYPES_H
#define WAVEPATH_RADIOSITY_TYPES_H

#include "kernels/base/frame_types.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// Texels R32UI: first a word for every instance (one in a scene without), which added to the index of a triangle gives
// the place of its root; then the roots, which are nodes.
GPU_CONSTANT uint kBindPatchRoots = 138u;
GPU_CONSTANT uint kBindPatchNodes = 139u; // texels R32UI: see kPatchLeaf
GPU_CONSTANT uint kBindPatches = 140u;    // texels RGBA32UI, kPatchTexels each: Patch. With links also those of nodes
GPU_CONSTANT uint kBindPatchSurfaces = 141u; // storage PatchSurface[]
GPU_CONSTANT uint kBindPatchLight = 142u;    // storage vec4[], one a face: irradiance by lights that are no patches
GPU_CONSTANT uint kBindShotBlocks = 143u;    // texels RGBA32UI: ShotBlock[] or LinkBlock[]
// Storage uint[], one a ray. Of a shot: the face that it hit; kNone if none. Of a link: bits of a float, the light
// along the ray up to a factor that the link's rays share; negative if something stops it.
GPU_CONSTANT uint kBindShotHits = 144u;
GPU_CONSTANT uint kBindCornerLight = 145u; // texels RGBA32F, three a face: irradiance at its corners
GPU_CONSTANT uint kBindSeenPoints = 146u;  // storage SeenPoint[], one a slot

// A node of the tree that a triangle is cut by: either kPatchLeaf | patch, or the first of four nodes. Of these, child
// k < 3 keeps corner k, and the last is the triangle of the middles of the sides, each in the place of the corner
// across.
GPU_CONSTANT uint kPatchLeaf = 0x80000000u;
GPU_CONSTANT uint kDeepestPatch = 12u; // levels of that tree; barycentrics of float hold more

// A patch, part of a triangle. Its faces are 2 * patch (front) and 2 * patch + 1 (back).
struct Patch {
  uint triangle;
  uint instance;
  vec2 corner[3]; // barycentric weights of the triangle's second and third vertex
};
GPU_CONSTANT uint kPatchTexels = 2u;
GPU_CHECK(sizeof(Patch) == 16 * kPatchTexels);

// Means of a patch's surface.
struct PatchSurface {
  vec3 reflectance;
  float opacity;
  vec3 emission;   // radiance of the front
  uint both_sides; // 1: the back shines as well
};
GPU_CHECK(sizeof(PatchSurface) == 32);

// Rays of a shot that lie side by side. The first word of a block without rays is kNone.
GPU_CONSTANT uint kBlockRays = 16u;
struct ShotBlock {
  uint face;
  uint first; // of its rays
  uint rays;  // of the whole shot; by hemicube: pixels along a side of the top face, | kHemicube
  uint shot;  // counts all shots
};
GPU_CHECK(sizeof(ShotBlock) == 16);
GPU_CONSTANT uint kHemicube = 0x80000000u;

// A link, whose kBlockRays rays lie side by side.
struct LinkBlock {
  uint a; // faces: 2 * place in kBindPatches + side
  uint b;
  uint number; // counts all links
  uint unused;
};
GPU_CHECK(sizeof(LinkBlock) == 16);

// Point at which a camera ray meets the mesh.
struct SeenPoint {
  Hit hit;
  vec3 weight; // reflectance there; 0 = nothing more to add
  uint back;   // 1: the ray sees the back
};
GPU_CHECK(sizeof(SeenPoint) == 32);

// Light of lamps on patches: samples of a face in one dispatch. Mesa 22.3 ends all loops of an invocation silently
// after 65,535 trips together, and one ray takes hundreds.
GPU_CONSTANT uint kPatchLightSamples = 16u;

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
