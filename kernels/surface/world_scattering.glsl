// Scattering of a Vertex (vertex.glsl) in world space: values, densities and samples of the BSDF, where the normals of
// facet, smooth surface and normal map differ.
#ifndef WAVEPATH_WORLD_SCATTERING_GLSL
#define WAVEPATH_WORLD_SCATTERING_GLSL

#include "kernels/surface/bsdf.glsl"

bool is_bent(Vertex v) { return has(kFeatureNormalMaps) && v.material.normal_texture != kNone; }

// True if light scattered to wi is reflected, not transmitted. The surface that a normal map stands for decides, not
// the bent normal, since lobes are folded at that surface (below).
bool is_above(Vertex v, vec3 wi) { return dot(wi, is_bent(v) ? v.plane : v.normal) > 0.0; }
bool is_below(Vertex v, vec3 wi) { return dot(wi, is_bent(v) ? v.plane : v.normal) < 0.0; }

// True if a direction leaves to the viewer's side of the facet.
bool is_on_viewers_side(Vertex v, vec3 wi) {
  vec3 facing = v.front ? v.surface.geometric_normal : -v.surface.geometric_normal;
  return dot(wi, facing) > 0.0;
}

// A direction must lie on the same side of the real surface as of the shading normal, or light would leak through.
bool sides_agree(Vertex v, vec3 wi) { return is_on_viewers_side(v, wi) == is_above(v, wi); }

// The same for a drawn direction. Delta lobes need no folding: there the lobe itself tells the side.
bool sides_agree(Vertex v, BsdfSample s, vec3 wi) {
  return is_bent(v) && s.pdf < 0.0 ? is_on_viewers_side(v, wi) != s.transmitted : sides_agree(v, wi);
}

// ---- folding --------------------------------------------------------------------------------------------------------
// Half of what a bent normal scatters may head below the surface that the map stands for, where no light is. It is
// mirrored up at that surface, and what it lets through down: value and density of a direction are those of the BSDF
// for it and for its mirror image, of each where the BSDF sends its light to wi's side of that surface. So a white
// surface returns all light whatever its map (cutting these directions off returned 57 % in a strong map). What a
// mirror folds cannot be followed back from the light, so that kernels of light paths, and those that meet them, define
// KEEPS_MIRRORS.
#ifdef KEEPS_MIRRORS
const bool kFoldsMirrors = false;
#else
const bool kFoldsMirrors = true;
#endif

vec3 to_local(Vertex v, vec3 direction) { return to_local(direction, v.tangent, v.bitangent, v.normal); }

// True if the BSDF sends light to wi itself that is not folded away. `local`: wi in the local basis.
bool has_itself(Vertex v, vec3 wi, vec3 local) {
  return !is_bent(v) || v.plane == v.normal || (local.z > 0.0) == (dot(wi, v.plane) > 0.0);
}

// The mirror image of wi, if the BSDF sends light on wi's side there.
bool has_image(Vertex v, vec3 wi, out vec3 image) {
  if (!is_bent(v)) return false;
  image = to_local(v, wi - 2.0 * dot(wi, v.plane) * v.plane);
  return (image.z > 0.0) == (dot(wi, v.plane) > 0.0) && v.plane != v.normal;
}

// f |cos| for light that the vertex sends to v.wo, and its density. wi must lie on the side that sides_agree() asks
// for.
vec3 vertex_eval(Vertex v, Lobes l, vec3 wi, vec3 local, out float pdf) {
  vec3 value = vec3(0.0), wo = to_local(v, v.wo), image;
  pdf = 0.0;
  const int end = has_image(v, wi, image) ? 2 : 1; // a loop: drivers compile one copy of the BSDF
  for (int i = has_itself(v, wi, local) ? 0 : 1; i < end; ++i) {
    float lobes_pdf;
    value += eval_lobes(v.bsdf, l, wo, i == 0 ? local : image, lobes_pdf);
    pdf += lobes_pdf;
  }
  return value;
}

vec3 vertex_eval(Vertex v, Lobes l, vec3 wi, out float pdf) { return vertex_eval(v, l, wi, to_local(v, wi), pdf); }

vec3 vertex_eval(Vertex v, vec3 wi, out float pdf) {
  pdf = 0.0;
  vec3 wo = to_local(v, v.wo);
  if (!(wo.z > 0.0)) return vec3(0.0);
  return vertex_eval(v, lobes_of(v.bsdf, wo), wi, pdf);
}

// A direction drawn in world space from the BSDF: the sampled one, or its image where it heads below.
vec3 drawn_direction(Vertex v, inout BsdfSample s) {
  vec3 wi = normalize(to_world(s.wi, v.tangent, v.bitangent, v.normal));
  bool folds = s.pdf >= 0.0 || (kFoldsMirrors && !s.transmitted);
  bool below = is_bent(v) && folds && (dot(wi, v.plane) > 0.0) != (s.wi.z > 0.0);
  if (!below) return wi;
  wi = normalize(wi - 2.0 * dot(wi, v.plane) * v.plane);
  s.wi = to_local(v, wi);
  return wi;
}

// True if f cos / pdf of a drawn direction is exactly the albedo, so that it need not be computed with rounding.
bool weight_is_albedo(Vertex v, vec3 wi) {
  vec3 image;
  return is_lambert(v.bsdf) && kHemisphere == kHemisphereCosine && !has_image(v, wi, image);
}

// Completes what was drawn with the density s.pdf, and has this value. False if there is no light to be had.
bool weigh_sample(Vertex v, vec3 value, bool is_albedo, inout BsdfSample s) {
  if (!(s.pdf > 0.0) || !is_finite(s.pdf)) return false;
  s.weight = is_albedo ? v.bsdf.base_color : value / s.pdf;
  return true;
}

// Draws a direction; false if the path ends here.
bool vertex_sample(Vertex v, float u_side, vec2 u, out BsdfSample s, out vec3 wi) {
  s = BsdfSample(vec3(0.0, 0.0, 1.0), vec3(0.0), 0.0, 1.0, false, false);
  vec3 wo = to_local(v, v.wo);
  if (!(wo.z > 0.0)) return false;
  Lobes l = lobes_of(v.bsdf, wo);
  bool delta;
  if (!bsdf_sample_direction(v.bsdf, l, wo, u_side, u, s, delta)) return false;
  wi = drawn_direction(v, s);
  if (delta) return true;
  vec3 value = vertex_eval(v, l, wi, s.wi, s.pdf);
  return weigh_sample(v, value, weight_is_albedo(v, wi), s);
}

#endif
