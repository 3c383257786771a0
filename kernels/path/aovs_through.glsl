// Albedo and normal through mirrors and smooth glass (kFeatureAovsThrough): those of the first surface on the path that
// scatters light in any other way, the albedo tinted by all before it. PathAovs::unoccluded, which is of no use to path
// tracing otherwise, is 1 while the path has met no such surface. Include bindings.glsl with BIND_PATHS first.
#ifndef WAVEPATH_AOVS_THROUGH_GLSL
#define WAVEPATH_AOVS_THROUGH_GLSL

#include "kernels/base/config.glsl"

bool shows_behind(uint slot) { return has_lobe(kFeatureAovsThrough) && path_aovs[slot].unoccluded > 0.0; }

// A vertex; `passes`: the path goes on through it as through a mirror.
void record_behind(uint slot, vec3 albedo, vec3 normal, bool passes) {
  path_aovs[slot].albedo = albedo;
  path_aovs[slot].normal = normal;
  path_aovs[slot].unoccluded = passes ? 1.0 : 0.0;
}

// A point within a body, or where the path leaves the scene: there is no normal, so that the last one stays.
void end_behind(uint slot, vec3 throughput) {
  if (!shows_behind(slot)) return;
  path_aovs[slot].albedo = throughput;
  path_aovs[slot].unoccluded = 0.0;
}

#endif
