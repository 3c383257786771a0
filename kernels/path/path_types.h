// Paths in flight, and the queues between the stages that trace them.
#ifndef WAVEPATH_PATH_TYPES_H
#define WAVEPATH_PATH_TYPES_H

#include "kernels/base/features.h"
#include "kernels/base/frame_types.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

GPU_CONSTANT uint kBindPaths = 20u;      // storage PathState[], one a slot
GPU_CONSTANT uint kBindRays = 21u;       // storage Ray[]: two queues, read and written in turn
GPU_CONSTANT uint kBindRayTexels = 22u;  // texels RGBA32F: the same memory, for reading
GPU_CONSTANT uint kBindHits = 23u;       // storage Hit[], one a ray in the queue
GPU_CONSTANT uint kBindShadowRays = 24u; // storage ShadowRay[]
GPU_CONSTANT uint kBindQueues = 25u;     // storage Queues
// Storage uint[], one a slot: material whose inside the path is in (kFeatureVolume): path/bodies.glsl.
GPU_CONSTANT uint kBindPathMedia = 26u;
GPU_CONSTANT uint kBindPathAovs = 27u;   // storage PathAovs[], one a slot (kFeatureAovs)
GPU_CONSTANT uint kBindPathTexels = 28u; // texels RGBA32F
GPU_CONSTANT uint kBindHitTexels = 29u;  // texels RGBA32UI
GPU_CONSTANT uint kBindSeen = 31u;       // storage vec4[], one a pixel, row-major (kFeatureSharedFirstHit): light that
                                         // reaches the eye without a bounce, fraction of the albedo that is no mirror
GPU_CONSTANT uint kBindShadowRayTexels = 30u; // texels RGBA32UI
GPU_CONSTANT uint kBindSortedRays = 48u; // storage uint[], one a slot (kSpecSort): indices in the queue of the rays
                                         // that hit, from the front, and of those that escaped, from the back
GPU_CONSTANT uint kBindSortedRayTexels = 49u; // texels R32UI
// Storage uvec4[], one a slot: samplers that generate keeps (kFeatureAdaptive), and behind all of them the vertex that
// the path was scattered at (kFeatureLightTree, or kFeaturePanes with triangle lights or soft lamps): position and
// packed normal, panes that it passed straight not counted; of a light path: the light that it began at.
GPU_CONSTANT uint kBindReceivers = 59u;
GPU_CONSTANT uint kBindReceiverTexels = 60u; // texels RGBA32UI
GPU_CONSTANT uint kBindGuideTree = 61u;      // texels RGBA32UI: nodes of the tree over space (kFeatureGuide)
GPU_CONSTANT uint kBindGuideMaps = 62u;      // texels RGBA32UI: maps of its leaves
// Storage: vec4[], GuideRecord[] (kFeatureTraining); or uvec4[], reuse_texel_count() a slot: what pixels tell their
// neighbours of paths (kSpecReuse). No render has both, and devices may allow few storage buffers.
GPU_CONSTANT uint kBindGuideRecords = 63u;
GPU_CONSTANT uint kBindReuseTexels = 90u;   // texels RGBA32UI: the same memory
GPU_CONSTANT uint kBindPathAovTexels = 91u; // texels RGBA32UI: kBindPathAovs
GPU_CONSTANT uint kBindPathGroups = 127u;   // storage float[]: see kernels/path/light_groups.glsl

struct PathState {
  vec3 throughput;
  // Density of the direction being traced, divided by the number of light samples at its vertex. Negative after a delta
  // lobe, where next-event estimation finds nothing. Unchanged where the path goes straight through a pane, which
  // shadow rays pass.
  float bsdf_pdf;
  vec3 radiance;
  float eta_scale; // product of squared relative iors crossed, undone for Russian roulette
};
GPU_CHECK(sizeof(PathState) == 32);

struct ShadowRay {
  vec3 origin;
  uint slot;
  // Vector to the point on the light, with t in (0,1). For distant lights: unit length, and t_max = kFar.
  vec3 direction;
  float t_max;
  vec3 contribution; // radiance that the path gains unless the ray is blocked
  uint light;        // index of the light
};
GPU_CHECK(sizeof(ShadowRay) == 48);

// Number of light samples at a bounce. `first`: where the path first scatters; every later vertex has half as many, as
// light that arrives by more bounces makes less noise.
GPU_FUNCTION uint light_samples_at(uint first, uint bounce) {
  return bounce < 8u && (first >> bounce) > 1u ? first >> bounce : 1u;
}

// Number of shadow rays of a vertex towards a sky of one colour; the path's own ray does not count. `first`: where the
// path first scatters. It is the same at every vertex; but with trained directions it decreases as light samples do.
GPU_FUNCTION uint sky_rays_at(uint first, bool learned, uint bounce) {
  return learned && first > 0u ? light_samples_at(first, bounce) : first;
}

// Queues of a bounce b. Every stage reads what those before it have appended; advance turns counts into sizes of the
// next dispatches.
//
//     generate (b = 0), or shade of bounce b - 1
//        |
//     rays, half b & 1             ray_count[b & 1] rays; the halves of the buffer take turns
//        |
//     extend ------------------->  hits: entry i is that of ray i
//        |
//     sorted_rays                  | indices of rays that hit ->     free     <- indices of rays that escaped |
//        |             |             hit_count, from the front                   escape_count, from the back
//     shade          escape        escape adds the environment. Without sorting, shade does so for all rays.
//        |
//        |--> rays, half (b + 1) & 1
//        '--> shadow_rays          queue i, from i * slot_count on: light sample i of every vertex
//                |
//             connect              once for each queue: paths gain the light of rays that nothing blocks
//
// Each light sample of a vertex has a queue of its own, one behind the other, so that a path gets light from one lane
// at a time.
struct Queues {
  uint ray_count[2];
  uint hit_count;        // hit_count and escape_count: of the rays that extend has sorted
  uint extend_groups[3]; // indirect dispatch sizes; shade uses extend's where rays are not sorted
  uint escape_count;
  uint connect_groups[3];
  uint first_shadow; // index of the first shadow ray that connect traces (kSpecLightSamples)
  uint shade_groups[3];
  uint next_ray; // index of the next ray to trace (trace_queue.glsl)
  uint escape_groups[3];
  uint next_shadow_ray;                 // index of the next shadow ray to trace
  uint shadow_count[kMostLightSamples]; // for each queue (sky.glsl); connect reads the first, which advance sets for it
  uint sender_count;                    // number of paths whose second vertex sends light to neighbours (reuse.glsl)
};
GPU_CHECK(sizeof(Queues) == 80 + 4 * kMostLightSamples);

// Steps of advance, whose push constant `bounce` is kAdvanceSteps * bounce + step. Queue i of shadow rays is
// kBeforeConnect + i. If rays are sorted and no other queue follows, it is kBeforeLastConnect + i, which also prepares
// extend of the next bounce: on CPU drivers a dispatch of one lane takes about 90 us.
GPU_CONSTANT uint kBeforeExtend = 0u, kBeforeShade = 1u, kBeforeConnect = 2u,
                  kBeforeLastConnect = kBeforeConnect + kMostLightSamples,
                  kAdvanceSteps = kBeforeLastConnect + kMostLightSamples;

// ---- reuse of paths: kernels/path/reuse.glsl ------------------------------------------------------------------------

// Texels of a slot, as many as the features of kernels ask for. The first vertex x of its path receives light, the
// second one y sends it.
// The first one: probability of the diffuse lobe at x (0: x does not share; negative: another lobe was drawn), instance
// of y + 1 (0: y does not share), reuse_quad(), id of the triangle of y.
GPU_CONSTANT uint kReuseHead = 0u;
GPU_CONSTANT uint kReuseReceiver = 1u;       // start of rays at x; coupling of x (pack_coupling())
GPU_CONSTANT uint kReuseReceiverColor = 2u;  // albedo of the diffuse lobe, without the coupling of the direction; ior
GPU_CONSTANT uint kReuseReceiverNormal = 3u; // shading normal, alpha
GPU_CONSTANT uint kReuseSender = 4u;         // end of rays to y; coupling of y
GPU_CONSTANT uint kReuseSenderPlane = 5u;    // geometric normal, ior
GPU_CONSTANT uint kReuseOwn = 6u;            // radiance that the path had gathered before y; alpha of y
GPU_CONSTANT uint kReuseWeights = 7u;        // weight of the light of y for each pixel of the quad
GPU_CONSTANT uint kReuseList = 8u;           // first word: list of the slots that have a sender, in the first slots
// Only in scenes with interfaces:
GPU_CONSTANT uint kReuseOther = 9u; // throughput of the lobes of x that share nothing
// Only in scenes with shading normals:
GPU_CONSTANT uint kReuseReceiverPlane = 10u; // geometric normal, on the side of the shading normal
GPU_CONSTANT uint kReuseSenderNormal = 11u;  // shading normal
// Only in scenes with normal maps:
GPU_CONSTANT uint kReuseReceiverMirror = 12u; // Vertex::plane, or zero where no map bends the normal

GPU_FUNCTION uint reuse_texel_count(Feature features) {
  if ((features & kFeatureNormalMaps) != 0u) return 13u;
  if ((features & kFeatureSmoothNormals) != 0u) return 12u;
  return (features & (kFeatureSpecular | kFeatureTransmission)) != 0u ? 10u : 9u;
}
GPU_CONSTANT uint kMostReuseTexels = 13u;

// ---- guiding: kernels/path/guide.glsl -------------------------------------------------------------------------------

// A vertex at which a path of the pilot scattered.
struct GuideRecord {
  vec3 position;
  // Density of the direction by all techniques; negative: delta lobe; 0: the path ended here, and nothing else is set.
  float pdf;
  vec3 direction;
  float bsdf_pdf;          // density by the BSDF alone
  float throughput;        // luminance, after this scattering
  float before;            // luminance that the path had gathered when it arrived at its next vertex
  float after;             // luminance that the whole path gathered
  float guidable_fraction; // part of the BSDF that can be guided
};
GPU_CHECK(sizeof(GuideRecord) == 48);
GPU_CONSTANT uint kGuideBounces = 8u; // recorded bounces of a path; bounce b of path p is record p * kGuideBounces + b

// Two levels of a binary tree, read with one fetch: the first split, that of its lower half and that of its upper half;
// their axes in pairs of bits of `links`, and above those the index of the first of four children. Where the first axis
// is kGuideLeafAxis it is a leaf: its number stands there instead, and splits.x is the probability of guiding.
struct GuideNode {
  vec3 splits;
  uint links;
};
GPU_CHECK(sizeof(GuideNode) == 16);
GPU_CONSTANT uint kGuideLeafAxis = 3u, kGuideLinkShift = 6u;

// The map of a leaf: the sphere over (azimuth, height) in kGuideSide^2 cells (guide_map.glsl tells how it is cut). A
// texel of kGuideQuads has the densities of 2x2 cells, as floats. Before them are blocks, from which a quad is drawn:
// the first one is of the 4x4 parts of the map, then there is one of the 4x4 quads of each such part. A block has 16
// weights of a byte, word c those of column c: the upper bits, without the sign, of a float whose exponent is
// kGuideWeightExponent more.
GPU_CONSTANT uint kGuideSide = 32u;
GPU_CONSTANT uint kGuideBlocks = 1u + 16u, kGuideQuads = kGuideSide * kGuideSide / 4u;
GPU_CONSTANT uint kGuideWeightShift = 20u, kGuideWeightExponent = 96u; // 2^-31 to 1.875
GPU_CONSTANT uint kGuideMapTexels = kGuideBlocks + kGuideQuads;

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
