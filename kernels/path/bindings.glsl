// Paths in flight and their queues, each group for kernels that define its macro before the include.
#ifndef WAVEPATH_PATH_BINDINGS_GLSL
#define WAVEPATH_PATH_BINDINGS_GLSL

#include "kernels/base/bindings.glsl"
#include "kernels/base/config.glsl"
#include "kernels/film/film_types.h"
#include "kernels/path/path_types.h"

#ifdef BIND_PATHS
layout(set = 0, binding = kBindPaths, std430) writeonly buffer PathBlock { uvec4 path_words[]; };
layout(set = 0, binding = kBindPathTexels) uniform samplerBuffer path_texels;
layout(set = 0, binding = kBindPathMedia, std430) buffer PathMediaBlock { uint path_media[]; };
layout(set = 0, binding = kBindPathAovs, std430) buffer PathAovBlock { PathAovs path_aovs[]; };
#endif

#ifdef BIND_PATH_AOV_TEXELS
layout(set = 0, binding = kBindPathAovTexels) uniform usamplerBuffer path_aov_texels;
#endif

#ifdef BIND_RECEIVERS
layout(set = 0, binding = kBindReceivers, std430) writeonly buffer ReceiverBlock { uvec4 receiver_words[]; };
layout(set = 0, binding = kBindReceiverTexels) uniform usamplerBuffer receiver_texels;
// Behind the samplers that generate keeps (path_sampler.glsl).
uint receiver_index(uint slot) { return has(kFeatureAdaptive) ? frame.slot_count + slot : slot; }
#endif

#ifdef BIND_LIGHT_SUMS
layout(set = 0, binding = kBindLightSums, std430) buffer LightSumBlock { uint light_sums[]; };
#endif

#ifdef BIND_RAYS
layout(set = 0, binding = kBindRays, std430) writeonly buffer RayBlock { uvec4 ray_words[]; };
layout(set = 0, binding = kBindRayTexels) uniform samplerBuffer ray_texels;
layout(set = 0, binding = kBindHits, std430) writeonly buffer HitBlock { uvec4 hit_words[]; };
layout(set = 0, binding = kBindHitTexels) uniform usamplerBuffer hit_texels;
#endif

#ifdef BIND_SORTED_RAYS
layout(set = 0, binding = kBindSortedRays, std430) writeonly buffer SortedRayBlock { uint sorted_rays[]; };
layout(set = 0, binding = kBindSortedRayTexels) uniform usamplerBuffer sorted_ray_texels;
#endif

#ifdef BIND_SHADOW_RAYS
layout(set = 0, binding = kBindShadowRays, std430) writeonly buffer ShadowRayBlock { uvec4 shadow_ray_words[]; };
layout(set = 0, binding = kBindShadowRayTexels) uniform usamplerBuffer shadow_ray_texels;
#endif

#ifdef BIND_QUEUES
layout(set = 0, binding = kBindQueues, std430) buffer QueueBlock { Queues queues; };
#endif

#ifdef BIND_GUIDE
layout(set = 0, binding = kBindGuideTree) uniform usamplerBuffer guide_tree;
layout(set = 0, binding = kBindGuideMaps) uniform usamplerBuffer guide_maps;
layout(set = 0, binding = kBindGuideRecords, std430) buffer GuideRecordBlock { vec4 guide_records[]; };
#endif

#ifdef BIND_REUSE
layout(set = 0, binding = kBindGuideRecords, std430) writeonly buffer ReuseBlock { uvec4 reuse_words[]; };
layout(set = 0, binding = kBindReuseTexels) uniform usamplerBuffer reuse_texels;
#endif

#ifdef BIND_GROUPS
layout(set = 0, binding = kBindPathGroups, std430) buffer PathGroupBlock { float path_groups[]; };
layout(set = 0, binding = kBindGroupTable) uniform usamplerBuffer group_table;
#endif

#ifdef BIND_SEEN
layout(set = 0, binding = kBindSeen, std430) buffer SeenBlock { vec4 seen[]; };
#endif

#endif
