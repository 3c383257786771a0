// A hybrid frame, each group for kernels that define its macro before the include.
#ifndef WAVEPATH_HYBRID_BINDINGS_GLSL
#define WAVEPATH_HYBRID_BINDINGS_GLSL

#include "kernels/base/bindings.glsl"
#include "kernels/hybrid/hybrid_types.h"

#ifdef BIND_HYBRID
layout(set = 0, binding = kBindHybrid, std140) uniform HybridBlock { HybridFrame hybrid; };
#endif

#ifdef BIND_VISIBILITY
layout(set = 0, binding = kBindVisibility) uniform usamplerBuffer visibility;
#endif

#ifdef BIND_GBUFFER
layout(set = 0, binding = kBindGbuffer, std430) buffer GbufferBlock { GbufferPixel gbuffer[]; };
#endif

#ifdef BIND_SIGNALS
layout(set = 0, binding = kBindSignals, std430) buffer SignalBlock { vec4 signals[]; };
#endif

#ifdef BIND_LAYERS
layout(set = 0, binding = kBindLayers, std430) buffer LayerBlock { vec4 layers[]; };
#endif

#ifdef BIND_REFLECTIONS
layout(set = 0, binding = kBindReflections, std430) buffer ReflectionBlock { vec4 reflections[]; };
#endif

#ifdef BIND_VELOCITIES
layout(set = 0, binding = kBindVelocities, std430) writeonly buffer VelocityBlock { vec2 velocities[]; };
#endif

#ifdef BIND_SHARED_COLORS
layout(set = 0, binding = kBindColorIds, std430) buffer ColorIdBlock { uvec2 color_ids[]; };
layout(set = 0, binding = kBindColorSeen, std430) buffer ColorSeenBlock { vec4 color_seen[]; };
layout(set = 0, binding = kBindColorSignals, std430) buffer ColorSignalBlock { vec4 color_signals[]; };
#endif

#ifdef BIND_FRACTIONS
layout(set = 0, binding = kBindFractions, std430) buffer FractionBlock { float fractions[]; };
#endif

#ifdef BIND_JITTERS
layout(set = 0, binding = kBindJitters, std430) writeonly buffer JitterBlock { vec2 jitters[]; };
#endif

#endif
