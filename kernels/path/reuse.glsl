// Reuse of paths (Bekaert, Sbert and Halton 2002, Accelerating Path Tracing by Re-Using Paths): the paths that the four
// pixels of a quad follow for one sample share the light that they find where they first scatter. Include bindings.glsl
// with BIND_REUSE first.
//
// Path j scatters at x_j, off the diffuse lobe, towards y_j, and finds there the radiance R_j that y_j sends back.
// Pixel i may use it as well, seen from x_i:
//
//   sum over j of  w_i T_i(y_j) K_ij R_j T_j(x_i) / T_j(x_j) / (sum over k of P_k K_kj)
//
// where K_ij = cos cos / (pi distance^2) between x_i and y_j, or 0 if they do not see each other: a path from x_i finds
// y_j with density P_i K_ij per area, P_i being the probability of the diffuse lobe. (Where a map bends the normal, the
// cosine at x_i is the sum of two, see kernels/surface/world_scattering.glsl.) w_i is the lobe's albedo, T the fraction
// of light along a direction that passes the interface above the diffuse base. So every path is a sample of one
// technique, weighed by the balance heuristic (Veach 1997, section 9.2), and the mean is that of paths that share
// nothing.
//
// Only the diffuse lobe of y_j takes part, whose light goes the same everywhere except for T: a path that arrives there
// continues from it or from the other lobes, by chance. Light that x_j scatters by its other lobes is not reused, nor
// is the light that the path gathers before y_j: emission, light samples at x_j, light of y_j itself.
//
// Between x and y must lie nothing: panes and BLEND surfaces stop the light that is shared, and paths that passed some
// share nothing.
#ifndef WAVEPATH_PATH_REUSE_GLSL
#define WAVEPATH_PATH_REUSE_GLSL

#include "kernels/surface/fresnel.glsl"
#include "kernels/path/path_types.h"
#include "kernels/base/pixel.glsl"

#define REUSES_PATHS (kReuse == kReuseQuads && frame.reuses_paths != 0u) // a macro, as has() is
#define TURNS_NORMALS has(kFeatureSmoothNormals | kFeatureNormalMaps)

uint reuse_index(uint slot, uint texel) { return texel * frame.slot_count + slot; }
vec4 fetch_reuse(uint slot, uint texel) {
  return uintBitsToFloat(texelFetch(reuse_texels, int(reuse_index(slot, texel))));
}
void store_reuse(uint slot, uint texel, vec3 v) { reuse_words[reuse_index(slot, texel)].xyz = floatBitsToUint(v); }
void store_reuse(uint slot, uint texel, vec3 v, float w) {
  reuse_words[reuse_index(slot, texel)] = floatBitsToUint(vec4(v, w));
}

// Rank of a slot's pixel in its quad, and number of entries of that quad, whose slots are consecutive.
uint reuse_quad(uint slot) {
  uint entry = slot_entry(slot);
  return rank_in_quad(entry, film_pixels()) + kQuadPixels * quad_entries(entry, film_area());
}

// Position of a sample in a picture whose quads are narrowed to those of a larger picture.
vec2 position_in_quad(uvec2 pixel, vec2 position) {
  if (kReuse == kReuseNone || frame.quad_scale == 1.0) return position; // unchanged, to the last bit
  vec2 middle = vec2(pixel / 2u * 2u) + 1.0;
  return middle + (position - middle) * frame.quad_scale;
}

void begin_reuse(uint slot) {
  if (!REUSES_PATHS) return;
  reuse_words[reuse_index(slot, kReuseHead)].xyz = uvec3(0u, 0u, reuse_quad(slot));
}

// Coupling of a direction to the diffuse base of a plain material: the arguments of interface_transmittance().
struct Coupling {
  float f0, f90, ior, alpha;
};

float pack_coupling(Interface i) { return uintBitsToFloat(packUnorm2x16(vec2(max_component(i.f0), i.f90))); }
Coupling unpack_coupling(float packed, float ior, float alpha) {
  vec2 ends = unpackUnorm2x16(floatBitsToUint(packed));
  return Coupling(ends.x, ends.y, ior, alpha);
}
float coupling_passes(Coupling c, float mu) {
  Interface i = make_interface(c.ior, vec3(1.0), c.f90, true);
  i.f0 = vec3(c.f0);
  return interface_transmittance(i, mu, c.alpha);
}

#endif
