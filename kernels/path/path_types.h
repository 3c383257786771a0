// Paths in flight, and the queues between the stages that trace them.
#ifndef WAVEPATH_PATH_TYPES_H
#define WAVEPATH_PATH_TYPES_H

#include "kernels/frame_types.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

GPU_CONSTANT uint kBindPaths = 20u;      // storage PathState[], one a slot
GPU_CONSTANT uint kBindRays = 21u;       // storage Ray[]: two queues, read and written in turn
GPU_CONSTANT uint kBindRayTexels = 22u;  // texels RGBA32F: the same memory, for reading
GPU_CONSTANT uint kBindHits = 23u;       // storage Hit[], one a ray in the queue
GPU_CONSTANT uint kBindShadowRays = 24u; // storage ShadowRay[]
GPU_CONSTANT uint kBindQueues = 25u;     // storage Queues
GPU_CONSTANT uint kBindPathMedia =
    26u; // storage uint[], one a slot: material whose inside the path is in (kFeatureVolume)
GPU_CONSTANT uint kBindPathAovs = 27u;   // storage PathAovs[], one a slot (kFeatureAovs)
GPU_CONSTANT uint kBindPathTexels = 28u; // texels RGBA32F
GPU_CONSTANT uint kBindHitTexels = 29u;  // texels RGBA32UI
GPU_CONSTANT uint kBindSeen = 31u;       // storage vec4[], one a pixel, row-major (kFeatureSharedFirstHit): light that
                                         // reaches the eye without a bounce, share of the albedo that is no mirror
GPU_CONSTANT uint kBindShadowRayTexels = 30u; // texels RGBA32UI
GPU_CONSTANT uint kBindReceivers = 59u;      // storage uvec4[], one a slot (kFeatureLightTree): position and packed normal of
                                             // the vertex that the path was scattered at
GPU_CONSTANT uint kBindReceiverTexels = 60u; // texels RGBA32UI

struct PathState {
  vec3 throughput;
  float bsdf_pdf; // of the direction being traced; negative after a delta lobe (no next-event estimation could find it)
  vec3 radiance;
  float eta_scale; // product of squared relative iors crossed, undone for Russian roulette
};
GPU_CHECK(sizeof(PathState) == 32);

struct ShadowRay {
  vec3 origin;
  uint slot;
  vec3 direction; // to the point on the light, not normalized: t in (0,1); unit length and t_max = kFar for distant
                  // lights
  float t_max;
  vec3 contribution; // what the path gains unless the ray is blocked
  uint light;        // Light that it goes to
};
GPU_CHECK(sizeof(ShadowRay) == 48);

struct Queues {
  uint ray_count[2];
  uint shadow_count;
  uint pad0;
  uint extend_groups[3]; // indirect dispatch sizes; shade uses extend's
  uint pad1;
  uint connect_groups[3];
  uint pad2;
};
GPU_CHECK(sizeof(Queues) == 48);

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
