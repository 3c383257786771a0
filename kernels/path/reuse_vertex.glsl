// The two vertices of a path that take part in the reuse of paths (reuse.glsl), as shade finds them. Include
// bindings.glsl with BIND_REUSE and BIND_PATHS first.
#ifndef WAVEPATH_PATH_REUSE_VERTEX_GLSL
#define WAVEPATH_PATH_REUSE_VERTEX_GLSL

#include "kernels/base/dimensions.glsl"
#include "kernels/path/medium.glsl"
#include "kernels/path/path_sampler.glsl"
#include "kernels/path/reuse.glsl"
#include "kernels/surface/vertex.glsl"

// True if the vertex has the diffuse lobe of reuse.glsl, with one normal for all directions.
bool may_reuse(Vertex v, Lobes l) {
  if (v.normal != v.bumped || !has_plain_base(v.bsdf) || max_component(l.diffuse) <= 0.0) return false;
  if (!kMicrofacets) return true;
  return v.bsdf.transmission == 0.0 && l.through == 0.0 && max_component(l.multiple) <= 0.0;
}

// Value of the diffuse lobe, as vertex_eval() has it.
vec3 diffuse_value(Vertex v, Lobes l, vec3 wi, vec3 local) {
  vec3 value = vec3(0.0), image;
  float pdf;
  if (local.z > 0.0 && has_itself(v, wi, local)) value = eval_diffuse(v.bsdf, l, local, pdf);
  if (has_image(v, wi, image) && image.z > 0.0) value += eval_diffuse(v.bsdf, l, image, pdf);
  return value;
}

vec3 facing_plane(Vertex v) { return v.front ? v.surface.geometric_normal : -v.surface.geometric_normal; }

// `w` is for the coupling, which a scene without interfaces does not have.
void store_with(uint slot, uint texel, vec3 v, float w) {
  if (kMicrofacets) store_reuse(slot, texel, v, w);
  else store_reuse(slot, texel, v);
}

// The first vertex, before the path scatters there. True if it receives.
bool begin_receiver(Vertex v, Lobes l, uint slot) {
  if (!may_reuse(v, l) || (has(kFeatureVolume) && current_body(slot) != kNone)) return false;
  vec3 plane = facing_plane(v);
  vec3 from = offset_ray_origin(v.surface.position, v.surface.position_error, v.surface.geometric_normal, plane);
  store_with(slot, kReuseReceiver, from, kMicrofacets ? pack_coupling(l.surface) : 0.0);
  store_with(slot, kReuseReceiverColor, l.diffuse, v.bsdf.ior);
  store_with(slot, kReuseReceiverNormal, v.normal, v.bsdf.alpha);
  if (TURNS_NORMALS) store_reuse(slot, kReuseReceiverPlane, plane);
  if (has(kFeatureNormalMaps))
    store_reuse(slot, kReuseReceiverMirror, is_bent(v) && v.plane != v.normal ? v.plane : vec3(0.0));
  reuse_words[reuse_index(slot, kReuseHead)].x = floatBitsToUint(-l.diffuse_probability);
  return true;
}

// Completes a receiver after its path has scattered by `s` to `wi`.
void scatter_receiver(Vertex v, Lobes l, BsdfSample s, vec3 wi, uint slot) {
  if (s.wide) reuse_words[reuse_index(slot, kReuseHead)].x = floatBitsToUint(l.diffuse_probability);
  if (!kMicrofacets) return;
  vec3 other = vec3(0.0);
  if (l.facet_probability > 0.0) other = s.weight;
  if (l.facet_probability > 0.0 && s.pdf > 0.0) other = max(other - diffuse_value(v, l, wi, s.wi) / s.pdf, vec3(0.0));
  store_reuse(slot, kReuseOther, other);
}

// Id of a triangle, by which rays to a surface skip it; Hit::triangle is its index in the tree.
uint triangle_id(Hit hit) { return floatBitsToUint(texelFetch(triangles, int(hit.triangle * kTriangleTexels + 1u)).w); }

// The second vertex, where the path has gathered what it finds of light that y sends by itself. `surface`: where the
// ray hit it, on the triangle. Takes from the lobes those that the path does not go on with. True if the vertex sends.
bool share_sender(Vertex v, Surface surface, Hit hit, uint slot, inout Lobes l, inout PathState path) {
  float drawn = fetch_reuse(slot, kReuseHead).x;
  if (drawn == 0.0 || !may_reuse(v, l)) return false;
  float before = max_component(path.throughput);
  bool sends = true;
  float probability = 1.0;
  if (kMicrofacets && l.facet_probability > 0.0) {
    probability = 0.5 + 0.5 * l.diffuse_probability;
    sends = sample_2d(fetch_sampler(slot), kDimensionReuse).x < probability;
  }
  if (!sends) {
    l.diffuse = vec3(0.0);
    l.diffuse_probability = 0.0;
    l.facet_probability = 1.0;
    path.throughput /= 1.0 - probability;
    path.eta_scale *= 1.0 - probability; // roulette goes by what the path would carry without the choice
    return false;
  }
  if (kMicrofacets) {
    l.diffuse_probability = 1.0;
    l.facet_probability = 0.0;
    l.delta_reflection = true; // leaves the facets out of eval_lobes()
  }
  if (drawn < 0.0) {
    path.throughput = fetch_reuse(slot, kReuseOther).xyz / probability;
  } else {
    // the facet's, though rays leave elsewhere
    vec3 plane = v.front ? surface.geometric_normal : -surface.geometric_normal;
    vec3 to = offset_ray_origin(surface.position, surface.position_error, surface.geometric_normal, plane);
    store_with(slot, kReuseSender, to, kMicrofacets ? pack_coupling(l.surface) : 0.0);
    store_with(slot, kReuseSenderPlane, plane, v.bsdf.ior);
    if (TURNS_NORMALS) store_reuse(slot, kReuseSenderNormal, v.normal);
    store_with(slot, kReuseOwn, path.radiance, v.bsdf.alpha);
    reuse_words[reuse_index(slot, kReuseHead)].y = hit.instance + 1u;
    reuse_words[reuse_index(slot, kReuseHead)].w = triangle_id(hit);
    path.radiance = vec3(0.0);
    path.throughput = vec3(1.0 / probability);
  }
  float after = max_component(path.throughput);
  path.eta_scale *= after > 0.0 ? before / after : 1.0;
  return drawn > 0.0;
}

void list_sender(uint index, uint slot) { reuse_words[reuse_index(index, kReuseList)].x = slot; }

#endif
