// Bindings that every kernel of a render may read: the constants of the render, the wave, the scene. A kernel asks for
// each group by a macro before the include, so that it declares only what it uses.
#ifndef WAVEPATH_BINDINGS_GLSL
#define WAVEPATH_BINDINGS_GLSL

#include "kernels/base/frame_types.h"
#include "kernels/base/light_tree_types.h"
#include "kernels/base/scene_types.h"

layout(set = 0, binding = kBindFrame, std140) uniform FrameBlock { Frame frame; };
layout(push_constant) uniform WaveBlock { Wave wave; };
layout(set = 0, binding = kBindEntries) uniform usamplerBuffer entry_texels;

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
#include "kernels/base/texel_pages.glsl"
layout(set = 0, binding = kBindSrgbTable) uniform samplerBuffer srgb_table;
layout(set = 0, binding = kBindAtlases + 0u) uniform sampler2DArray value_atlas;
layout(set = 0, binding = kBindAtlases + 1u) uniform sampler2DArray color_atlas;
#endif

#ifdef BIND_LIGHTS
layout(set = 0, binding = kBindLights) uniform usamplerBuffer light_texels;
#endif

#ifdef BIND_LIGHT_TREE
layout(set = 0, binding = kBindLightTree) uniform usamplerBuffer light_tree;
layout(set = 0, binding = kBindLightCells) uniform usamplerBuffer light_cells;
#endif

#ifdef BIND_ENVIRONMENT
layout(set = 0, binding = kBindEnvironment) uniform samplerBuffer environment;
layout(set = 0, binding = kBindEnvironmentEnds) uniform usamplerBuffer environment_ends;
#endif

#ifdef BIND_COUNTERS
layout(set = 0, binding = kBindCounters, std430) buffer CounterBlock { Counters counters; };
#endif

#endif
