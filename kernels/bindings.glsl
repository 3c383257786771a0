// What a kernel can see. A kernel asks for each group by a macro before the include, so that it declares only what it uses.
#ifndef WAVEPATH_BINDINGS_GLSL
#define WAVEPATH_BINDINGS_GLSL

#include "kernels/gpu_types.h"

layout(set = 0, binding = kBindFrame, std140) uniform FrameBlock { Frame frame; };
layout(push_constant) uniform WaveBlock { Wave wave; };
layout(set = 0, binding = kBindRuns) uniform usamplerBuffer run_texels;

#ifdef BIND_GEOMETRY
layout(set = 0, binding = kBindNodes) uniform usamplerBuffer nodes;
layout(set = 0, binding = kBindTriangles) uniform samplerBuffer triangles;
layout(set = 0, binding = kBindInstances) uniform samplerBuffer instances;
#endif

#ifdef BIND_SURFACES
layout(set = 0, binding = kBindTriangleVertices) uniform usamplerBuffer triangle_vertices;
layout(set = 0, binding = kBindVertexNormals) uniform samplerBuffer vertex_normals;
layout(set = 0, binding = kBindVertexUvs) uniform samplerBuffer vertex_uvs;
layout(set = 0, binding = kBindVertexColors) uniform samplerBuffer vertex_colors;
layout(set = 0, binding = kBindMaterials) uniform usamplerBuffer material_texels;
layout(set = 0, binding = kBindTextures) uniform usamplerBuffer texture_texels;
layout(set = 0, binding = kBindTexels) uniform usamplerBuffer texels;
layout(set = 0, binding = kBindSrgbTable) uniform samplerBuffer srgb_table;
#endif

#ifdef BIND_LIGHTS
layout(set = 0, binding = kBindLights) uniform usamplerBuffer light_texels;
#endif

#ifdef BIND_ENVIRONMENT
layout(set = 0, binding = kBindEnvironment) uniform samplerBuffer environment;
layout(set = 0, binding = kBindEnvironmentAlias) uniform usamplerBuffer environment_alias;
#endif

#ifdef BIND_PATHS
layout(set = 0, binding = kBindPaths, std430) writeonly buffer PathBlock { uvec4 path_words[]; };
layout(set = 0, binding = kBindPathTexels) uniform samplerBuffer path_texels;
layout(set = 0, binding = kBindPathMedia, std430) buffer PathMediaBlock { uint path_media[]; };
layout(set = 0, binding = kBindPathAovs, std430) buffer PathAovBlock { PathAovs path_aovs[]; };
#endif

#ifdef BIND_RAYS
layout(set = 0, binding = kBindRays, std430) writeonly buffer RayBlock { uvec4 ray_words[]; };
layout(set = 0, binding = kBindRayTexels) uniform samplerBuffer ray_texels;
layout(set = 0, binding = kBindHits, std430) writeonly buffer HitBlock { uvec4 hit_words[]; };
layout(set = 0, binding = kBindHitTexels) uniform usamplerBuffer hit_texels;
#endif

#ifdef BIND_SHADOW_RAYS
layout(set = 0, binding = kBindShadowRays, std430) writeonly buffer ShadowRayBlock { uvec4 shadow_ray_words[]; };
layout(set = 0, binding = kBindShadowRayTexels) uniform usamplerBuffer shadow_ray_texels;
#endif

#ifdef BIND_QUEUES
layout(set = 0, binding = kBindQueues, std430) buffer QueueBlock { Queues queues; };
#endif

#ifdef BIND_FILM
layout(set = 0, binding = kBindFilm, std430) writeonly buffer FilmBlock { uvec4 film_words[]; };
layout(set = 0, binding = kBindFilmTexels) uniform usamplerBuffer film_texels;
layout(set = 0, binding = kBindFilmAovs, std430) buffer FilmAovBlock { FilmAovs film_aovs[]; };
#endif

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

#ifdef BIND_SEEN
layout(set = 0, binding = kBindSeen, std430) buffer SeenBlock { vec4 seen[]; };
#endif

#ifdef BIND_JITTERS
layout(set = 0, binding = kBindJitters, std430) writeonly buffer JitterBlock { vec2 jitters[]; };
#endif

#endif
