// Bindings of the bidirectional kernels besides those of paths; each group for kernels that define its macro before the
// include.
#ifndef WAVEPATH_BIDIRECTIONAL_BINDINGS_GLSL
#define WAVEPATH_BIDIRECTIONAL_BINDINGS_GLSL

#define KEEPS_MIRRORS // see kernels/surface/world_scattering.glsl

#include "kernels/bidirectional/bidirectional_types.h"
#include "kernels/bidirectional/photon_types.h"
#include "kernels/film/film_types.h"
#include "kernels/path/bindings.glsl"

layout(set = 0, binding = kBindBidirectional, std140) uniform BidirectionalBlock { BidirectionalFrame bidirectional; };

layout(set = 0, binding = kBindPhotonFrame, std140) uniform PhotonFrameBlock { PhotonFrame photon_frame; };

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

#ifdef BIND_PHOTONS
layout(set = 0, binding = kBindPhotons, std430) writeonly buffer PhotonBlock { uvec4 photon_words[]; };
layout(set = 0, binding = kBindPhotonTexels) uniform usamplerBuffer photon_texels;
layout(set = 0, binding = kBindPhotonCells, std430) buffer PhotonCellBlock { uvec2 photon_cells[]; };
layout(set = 0, binding = kBindPhotonCellTexels) uniform usamplerBuffer photon_cell_texels;
#endif

#ifdef BIND_MERGE_WEIGHTS
layout(set = 0, binding = kBindMergeWeights, std430) buffer MergeWeightBlock { float merge_weights[]; };
#endif

#ifdef BIND_SPLATS
layout(set = 0, binding = kBindSplats, std430) buffer SplatBlock { uint splat_words[]; };
#endif

#endif
