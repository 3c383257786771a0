// What bidirectional kernels share besides paths, each group for kernels that define its macro before the include.
#ifndef WAVEPATH_BIDIRECTIONAL_BINDINGS_GLSL
#define WAVEPATH_BIDIRECTIONAL_BINDINGS_GLSL

#include "kernels/bidirectional/bidirectional_types.h"
#include "kernels/film/film_types.h"
#include "kernels/path/bindings.glsl"

layout(set = 0, binding = kBindBidirectional, std140) uniform BidirectionalBlock { BidirectionalFrame bidirectional; };

#ifdef BIND_PATH_WEIGHTS
layout(set = 0, binding = kBindPathWeights, std430) buffer PathWeightBlock { vec2 path_weights[]; };
#endif

#ifdef BIND_LIGHT_VERTICES
layout(set = 0, binding = kBindLightVertices, std430) writeonly buffer LightVertexBlock { uvec4 light_vertex_words[]; };
layout(set = 0, binding = kBindLightVertexTexels) uniform usamplerBuffer light_vertex_texels;
layout(set = 0, binding = kBindLightCounts, std430) buffer LightCountBlock { uint light_counts[]; };
#endif

#ifdef BIND_CONNECTIONS
layout(set = 0, binding = kBindConnections, std430) writeonly buffer ConnectionBlock { uvec4 connection_words[]; };
layout(set = 0, binding = kBindConnectionTexels) uniform usamplerBuffer connection_texels;
layout(set = 0, binding = kBindConnectionQueue, std430) buffer ConnectionQueueBlock { ConnectionQueue connections; };
#endif

#ifdef BIND_SPLATS
layout(set = 0, binding = kBindSplats, std430) buffer SplatBlock { uint splat_words[]; };
#endif

#endif
