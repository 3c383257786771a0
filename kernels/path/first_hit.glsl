// What AOVs show of the first hit of a path. Include bindings.glsl with BIND_PATHS first.
#ifndef WAVEPATH_FIRST_HIT_GLSL
#define WAVEPATH_FIRST_HIT_GLSL

#include "kernels/vertex.glsl"

void record_first_hit(uint slot, Vertex v, vec3 origin) {
  path_aovs[slot].albedo = v.bsdf.base_color;
  path_aovs[slot].normal = v.normal;
  path_aovs[slot].position = v.surface.position;
  path_aovs[slot].depth = dot(v.surface.position - origin, frame.camera_forward);
  path_aovs[slot].hit = 1.0;
}

#endif
