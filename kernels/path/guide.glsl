// Path guiding: directions drawn from a field trained on the light that arrives, beside those of the BSDF
// (one-sample MIS).
//
// The field is a tree over space, in the spirit of Mueller, Gross and Novak, "Practical Path Guiding" (EGSR 2017). Each
// leaf holds a density over the sphere (guide_map.glsl). The host builds it (host/integrators/path/guide_field.h).
// Include bindings.glsl with BIND_GUIDE first.
#ifndef WAVEPATH_GUIDE_GLSL
#define WAVEPATH_GUIDE_GLSL

#include "kernels/surface/bsdf_types.glsl"
#include "kernels/base/math.glsl"
#include "kernels/path/guide_map.glsl"
#include "kernels/path/path_types.h"

// Guiding at a vertex.
struct Guide {
  uint map;                // first texel of the leaf's map
  float probability;       // probability of drawing from the map
  float guidable_fraction; // part of the BSDF that is guided; delta lobes and narrow ones find their light themselves
};

const float kGuidedAlpha = 0.1; // narrower facets are not guided

Guide no_guide() { return Guide(0u, 0.0, 0.0); }

// ---- the field --------------------------------------------------------------------------------------------------

Guide find_guide(Lobes l, float alpha, vec3 position) {
  uvec4 node = texelFetch(guide_tree, 0);
  while ((node.w & 3u) != kGuideLeafAxis) {
    bool upper = !(position[node.w & 3u] < uintBitsToFloat(node.x));
    uint axis = node.w >> (upper ? 4u : 2u) & 3u;
    bool second = !(position[axis] < uintBitsToFloat(upper ? node.z : node.y));
    node = texelFetch(guide_tree, int((node.w >> kGuideLinkShift) + (upper ? 2u : 0u) + (second ? 1u : 0u)));
  }
  float fraction = l.diffuse_probability + l.facet_probability * smoothstep(0.5 * kGuidedAlpha, kGuidedAlpha, alpha);
  return Guide((node.w >> kGuideLinkShift) * kGuideMapTexels, fraction * uintBitsToFloat(node.x), fraction);
}

// ---- together with the BSDF -------------------------------------------------------------------------------------

// Density of a direction by both techniques. Delta lobes are no part of either.
float guided_pdf(Guide guide, float bsdf_pdf, vec3 direction) {
  return mix(bsdf_pdf, map_pdf(guide.map, direction), guide.probability);
}

// ---- what the pilot notes ---------------------------------------------------------------------------------------

uint guide_record(uint path, uint bounce) { return 3u * (path * kGuideBounces + bounce); }

// The path scattered at `bounce`; throughput includes it.
void note_scattering(uint path, uint bounce, Guide guide, vec3 position, vec3 direction, float pdf, float bsdf_pdf,
                     vec3 throughput) {
  if (bounce >= kGuideBounces) return;
  uint at = guide_record(path, bounce);
  guide_records[at] = vec4(position, pdf);
  guide_records[at + 1u] = vec4(direction, bsdf_pdf);
  guide_records[at + 2u] = vec4(luminance(throughput), 0.0, 0.0, guide.guidable_fraction);
}
// The path goes on from the vertex of `bounce`, in a direction that is not guided, as after a delta lobe.
void note_unguided(uint path, uint bounce) {
  if (bounce < kGuideBounces) guide_records[guide_record(path, bounce)] = vec4(0.0, 0.0, 0.0, -1.0);
}
// The path arrived at the vertex of `bounce`, with this radiance gathered so far.
void note_arrival(uint path, uint bounce, vec3 radiance) {
  if (bounce > 0u && bounce <= kGuideBounces)
    guide_records[guide_record(path, bounce - 1u) + 2u].y = luminance(radiance);
}
void note_end(uint path, uint bounce) {
  if (bounce < kGuideBounces) guide_records[guide_record(path, bounce)].w = 0.0;
}

#endif
