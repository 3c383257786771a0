// Path guiding: directions drawn from what a pilot learned of the light that arrives, beside those of the BSDF
// (one-sample MIS).
//
// The field is a tree over space, in the spirit of Mueller, Gross and Novak, "Practical Path Guiding" (EGSR 2017). Each
// leaf holds a density over the sphere: a pyramid of 2x2 cells over the equal-area map (azimuth, height), read with one
// fetch where only the density is asked for. The host builds it (host/integrators/path/guide_field.h). Include
// bindings.glsl with BIND_GUIDE first.
#ifndef WAVEPATH_GUIDE_GLSL
#define WAVEPATH_GUIDE_GLSL

#include "kernels/bsdf_types.glsl"
#include "kernels/math.glsl"
#include "kernels/path/path_types.h"

// What guides a path at a vertex.
struct Guide {
  uint map;          // first quad of the leaf's pyramid
  float probability; // of drawing from it
  float share;       // of the BSDF that can be guided: delta lobes and narrow ones find their light themselves
};

const float kGuidedAlpha = 0.1; // narrower facets are not guided

Guide no_guide() { return Guide(0u, 0.0, 0.0); }

// ---- the map of the sphere --------------------------------------------------------------------------------------

vec2 guide_uv(vec3 d) {
  vec2 uv = vec2(atan2_exact(d.z, d.x) * (0.5 * kInvPi) + 0.5, 0.5 * d.y + 0.5);
  return clamp(uv, 0.0, kOneMinusEpsilon);
}

vec3 guide_direction(vec2 uv) {
  float y = 2.0 * uv.y - 1.0;
  vec2 around = sqrt(max((1.0 - y) * (1.0 + y), 0.0)) * cos_sin_turns(uv.x - 0.5);
  return vec3(around.x, y, around.y);
}

uint quad_place(uint map, uint level, uvec2 quad) { return map + ((1u << (2u * level)) - 1u) / 3u + (quad.y << level) + quad.x; }

// ---- the field --------------------------------------------------------------------------------------------------

Guide find_guide(Lobes l, float alpha, vec3 position) {
  uvec4 node = texelFetch(guide_tree, 0);
  while ((node.w & 3u) != kGuideLeafAxis) {
    bool upper = !(position[node.w & 3u] < uintBitsToFloat(node.x));
    uint axis = node.w >> (upper ? 4u : 2u) & 3u;
    bool second = !(position[axis] < uintBitsToFloat(upper ? node.z : node.y));
    node = texelFetch(guide_tree, int((node.w >> kGuideLinkShift) + (upper ? 2u : 0u) + (second ? 1u : 0u)));
  }
  float share = l.diffuse_probability + l.facet_probability * smoothstep(0.5 * kGuidedAlpha, kGuidedAlpha, alpha);
  return Guide((node.w >> kGuideLinkShift) * kGuideMapQuads, share * uintBitsToFloat(node.x), share);
}

// Density per solid angle.
float guide_pdf(Guide guide, vec3 direction) {
  uvec2 cell = uvec2(guide_uv(direction) * float(kGuideSide));
  vec4 quad = texelFetch(guide_maps, int(quad_place(guide.map, kGuideLevels - 1u, cell >> 1u)));
  vec2 pair = (cell.y & 1u) == 0u ? quad.xy : quad.zw;
  return (cell.x & 1u) == 0u ? pair.x : pair.y;
}

// Chooses one of two by their weights; u is stretched to [0, 1) again.
bool choose_second(float first, float second, inout float u) {
  float share = first / (first + second);
  bool is_second = !(u < share);
  u = min(is_second ? (u - share) / (1.0 - share) : u / share, kOneMinusEpsilon);
  return is_second;
}

// A direction with that density. Halves first in azimuth, then in height, level by level: neighbours stay neighbours,
// so that a net stays one.
vec3 sample_guide(Guide guide, vec2 u) {
  uvec2 cell = uvec2(0u);
  for (uint level = 0u; level < kGuideLevels; ++level) {
    vec4 quad = texelFetch(guide_maps, int(quad_place(guide.map, level, cell)));
    bool right = choose_second(quad.x + quad.z, quad.y + quad.w, u.x);
    bool upper = choose_second(right ? quad.y : quad.x, right ? quad.w : quad.z, u.y);
    cell = 2u * cell + uvec2(right, upper);
  }
  return guide_direction((vec2(cell) + u) / float(kGuideSide));
}

// ---- together with the BSDF -------------------------------------------------------------------------------------

// Density of a direction by both techniques. Delta lobes are no part of either.
float guided_pdf(Guide guide, float bsdf_pdf, vec3 direction) {
  return mix(bsdf_pdf, guide_pdf(guide, direction), guide.probability);
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
  guide_records[at + 2u] = vec4(luminance(throughput), 0.0, 0.0, guide.share);
}
// The path arrived at the vertex of `bounce`, with this radiance gathered so far.
void note_arrival(uint path, uint bounce, vec3 radiance) {
  if (bounce > 0u && bounce <= kGuideBounces) guide_records[guide_record(path, bounce - 1u) + 2u].y = luminance(radiance);
}
void note_end(uint path, uint bounce) {
  if (bounce < kGuideBounces) guide_records[guide_record(path, bounce)].w = 0.0;
}

#endif
