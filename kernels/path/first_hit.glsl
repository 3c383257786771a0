// What AOVs show of the first hit of a path. Include bindings.glsl with BIND_PATHS first.
#ifndef WAVEPATH_FIRST_HIT_GLSL
#define WAVEPATH_FIRST_HIT_GLSL

#include "kernels/vertex.glsl"

// `position`: on the facet, wherever rays leave from.
void record_first_hit(uint slot, Vertex v, vec3 position, vec3 origin) {
  path_aovs[slot].albedo = v.bsdf.base_color;
  path_aovs[slot].normal = v.normal;
  path_aovs[slot].position = position;
  path_aovs[slot].depth = dot(position - origin, frame.camera_forward);
  path_aovs[slot].hit = 1.0;
}

#endif
