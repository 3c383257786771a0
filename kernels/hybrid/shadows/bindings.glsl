// Views of lights and their maps, each group for kernels that define its macro before the include.
#ifndef WAVEPATH_SHADOW_BINDINGS_GLSL
#define WAVEPATH_SHADOW_BINDINGS_GLSL

#include "kernels/base/bindings.glsl"
#include "kernels/hybrid/shadows/shadow_types.h"

layout(set = 0, binding = kBindShadowFrame, std140) uniform ShadowBlock { ShadowFrame shadow; };
layout(set = 0, binding = kBindShadowViews) uniform samplerBuffer shadow_views;

#ifdef BIND_SHADOW_LIGHTS
layout(set = 0, binding = kBindShadowLights) uniform usamplerBuffer shadow_lights;
#endif

#ifdef BIND_SHADOW_DEPTHS
layout(set = 0, binding = kBindShadowDepths) uniform samplerBuffer shadow_depths;
#endif

#ifdef BIND_SHADOW_IDS
layout(set = 0, binding = kBindShadowIds) uniform usamplerBuffer shadow_ids;
#endif

#ifdef BIND_SHADOW_MAP_WORDS
layout(set = 0, binding = kBindShadowDepthWords, std430) buffer ShadowDepthBlock { float depth_words[]; };
layout(set = 0, binding = kBindShadowIdWords, std430) buffer ShadowIdBlock { uvec2 id_words[]; };
#endif

#ifdef BIND_SHADOW_TAPS
layout(set = 0, binding = kBindShadowTaps) uniform samplerBuffer shadow_taps;
#endif

#ifdef BIND_SHADOW_FILTERED
layout(set = 0, binding = kBindShadowFiltered) uniform samplerBuffer shadow_filtered;
#endif

#ifdef BIND_SHADOW_FILTERED_WORDS
layout(set = 0, binding = kBindShadowFilteredWords, std430) buffer ShadowFilteredBlock { vec4 filtered_words[]; };
#endif

#ifdef BIND_SHADOW_SCRATCH
layout(set = 0, binding = kBindShadowScratch, std430) buffer ShadowScratchBlock { uvec4 shadow_scratch[]; };
#endif

#ifdef BIND_SHADOW_COUNTS
layout(set = 0, binding = kBindShadowCounts, std430) buffer ShadowCountBlock { ShadowCounts shadow_counts; };
#endif

#ifdef BIND_SHADOW_PAGES
// Page table of virtual maps: the slot of every page, kNone if it is not resident; then the page of every slot.
layout(set = 0, binding = kBindShadowScratch, std430) readonly buffer ShadowPageBlock { uint page_words[]; };
#endif

#endif
