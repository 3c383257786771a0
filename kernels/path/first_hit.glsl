// AOVs of the first hit of a path. Include bindings.glsl with BIND_PATHS first.
#ifndef WAVEPATH_FIRST_HIT_GLSL
#define WAVEPATH_FIRST_HIT_GLSL

#include "kernels/base/camera.glsl"
#include "kernels/surface/vertex.glsl"

// Identifies the surface that a ray has hit, by the numbers of the scene file.
void identify(Hit hit, uint material, inout PathAovs aovs) {
  aovs.triangle = floatBitsToUint(texelFetch(triangles, int(hit.triangle * kTriangleTexels + 1u)).w);
  if ((aovs.triangle & kPieceId) != 0u) aovs.triangle = texelFetch(triangle_vertices, int(hit.triangle)).w;
  aovs.instance =
      is_instanced() ? floatBitsToUint(texelFetch(instances, int(hit.instance * kInstanceTexels + 6u)).z) : 0u;
  aovs.material = material;
}

#ifdef BIND_PATHS
// `position`: on the facet, wherever rays leave from.
void record_first_hit(uint slot, Hit hit, Vertex v, vec3 position, vec3 origin) {
  path_aovs[slot].albedo = v.bsdf.base_color;
  path_aovs[slot].normal = v.normal;
  path_aovs[slot].position = position;
  path_aovs[slot].depth = camera_depth(position, origin);
  path_aovs[slot].hit = 1.0;
  path_aovs[slot].roughness = sqrt(v.bsdf.alpha);
  path_aovs[slot].metallic = v.bsdf.metallic;
  PathAovs ids;
  identify(hit, v.surface.material, ids);
  path_aovs[slot].triangle = ids.triangle;
  path_aovs[slot].instance = ids.instance;
  path_aovs[slot].material = ids.material;
}
#endif

#endif
