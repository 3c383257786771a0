// The point where a ray hits: surface, material and BSDF, and the medium on either side. Include bindings.glsl with
// BIND_GEOMETRY and BIND_SURFACES first.
#ifndef WAVEPATH_VERTEX_GLSL
#define WAVEPATH_VERTEX_GLSL

#include "kernels/bsdf.glsl"
#include "kernels/surface.glsl"

// Everything about the point that scattering needs.
struct Vertex {
  Surface surface;
  Material material;
  bool front;
  vec3 wo;
  vec3 bumped; // shading normal on wo's side
  vec3 normal; // the same, held towards wo
  vec3 tangent, bitangent;
  Bsdf bsdf;
  vec3 plane; // the normal before a map bent it, on wo's side (kFeatureNormalMaps)
#ifdef LAYERED
  vec3 coat_normal; // world, on wo's side (kLobeCoat)
  vec3 grain;       // world: the direction along which microfacets are stretched, zero if they are not (kLobeAnisotropy)
#endif
};

Bsdf make_bsdf(Material material, vec4 uv, vec3 base, bool front) {
  Bsdf b;
  b.base_color = base;
  b.metallic = material.metallic;
  float roughness = material.roughness;
  b.transmission = 0.0;
  b.specular = material.specular;
  b.specular_color = material.specular_color;
  if (has(kFeatureSpecular)) {
    vec4 metallic_roughness =
        sample_value_or_1(kFeatureMetallicRoughnessTextures, material.metallic_roughness_texture, uv);
    b.metallic *= metallic_roughness.b;
    roughness *= metallic_roughness.g;
    b.specular *= sample_value_or_1(kFeatureSpecularTextures, material.specular_texture, uv).a;
    b.specular_color *= sample_color_or_1(kFeatureSpecularTextures, material.specular_color_texture, uv).rgb;
  }
  if (has(kFeatureTransmission))
    b.transmission =
        material.transmission * sample_value_or_1(kFeatureTransmissionTextures, material.transmission_texture, uv).r;
  b.alpha = roughness * roughness;
  b.ior = material.ior;
  b.entering = front;
  b.thin = (material.flags & kMaterialVolume) == 0u;
  b.ggx_table = b.glass_table = kNone;
  return b;
}

#ifdef LAYERED
#include "kernels/vertex_layers.glsl"
#else
void read_layers(inout Vertex v) {}
void set_layer_basis(inout Vertex v) {}
void turn_layers(inout Vertex v) {}
bool lets_light_pass(Vertex v) { return v.bsdf.transmission > 0.0; }
#endif

// The local basis for wo, and what the BSDF has in it.
void set_basis(inout Vertex v) {
  v.normal = held_normal(v.bumped, v.wo);
  make_basis(v.normal, v.tangent, v.bitangent);
  set_layer_basis(v);
}

// The same point, met from the other side.
void turn_over(inout Vertex v) {
  v.bumped = -v.bumped;
  v.plane = -v.plane;
  turn_layers(v);
}

Vertex make_vertex(Surface surface, Material material, vec3 direction) {
  Vertex v;
  v.surface = surface;
  v.material = material;
  v.wo = -direction;
  v.front = dot(surface.geometric_normal, v.wo) >= 0.0;
  v.bumped = bumped_normal(surface, material, v.front);
  vec3 base = base_color(material, surface.uv, surface.color).rgb;
  v.bsdf = make_bsdf(material, surface.uv, base, v.front);
  v.plane = v.bumped;
  if (has(kFeatureNormalMaps)) {
    vec3 n = surface.vertex_normal;
    v.plane = dot(n, v.front ? surface.geometric_normal : -surface.geometric_normal) < 0.0 ? -n : n;
  }
  if (uses_lobe(kLobeMultiple)) {
    uvec4 tables = fetch_layers(surface.material, 8u);
    v.bsdf.ggx_table = tables.y;
    v.bsdf.glass_table = tables.w;
  }
  read_layers(v);
  set_basis(v);
  // What lets light pass keeps its facets, between which the two sides of a body agree.
  if (kTerminator == kTerminatorSmooth && !lets_light_pass(v)) lift_surface(v.surface, v.front);
  return v;
}

bool is_bent(Vertex v) { return has(kFeatureNormalMaps) && v.material.normal_texture != kNone; }

// Whether the vertex reflects what it scatters to wi, rather than letting it through: by the surface that a map stands for,
// not by the normal that it bends, since lobes are folded at that surface (below).
bool is_above(Vertex v, vec3 wi) { return dot(wi, is_bent(v) ? v.plane : v.normal) > 0.0; }
bool is_below(Vertex v, vec3 wi) { return dot(wi, is_bent(v) ? v.plane : v.normal) < 0.0; }

// Whether a direction leaves to the viewer's side of the facet.
bool is_on_viewers_side(Vertex v, vec3 wi) {
  vec3 facing = v.front ? v.surface.geometric_normal : -v.surface.geometric_normal;
  return dot(wi, facing) > 0.0;
}

// A direction must lie on the same side of the real surface as of the shading normal, or light would leak through.
bool sides_agree(Vertex v, vec3 wi) { return is_on_viewers_side(v, wi) == is_above(v, wi); }

// The same of a drawn direction. Delta lobes need not be folded: there the lobe tells the side.
bool sides_agree(Vertex v, BsdfSample s, vec3 wi) {
  return is_bent(v) && s.pdf < 0.0 ? is_on_viewers_side(v, wi) != s.transmitted : sides_agree(v, wi);
}

// ---- scattering in world space --------------------------------------------------------------------------------------
// Half of what a bent normal scatters may head below the surface that the map stands for, where no light is. It is mirrored
// up at that surface, and what it lets through down: value and density of a direction are those of the BSDF for it and for
// its mirror image, of each where the BSDF sends its light to wi's side of that surface. So a white surface returns all
// light whatever its map (cutting these directions off returned 57 % in a strong map). What a mirror folds cannot be
// followed back from the light, so that kernels of light paths, and those that meet them, define KEEPS_MIRRORS.
#ifdef KEEPS_MIRRORS
const bool kFoldsMirrors = false;
#else
const bool kFoldsMirrors = true;
#endif

vec3 to_local(Vertex v, vec3 direction) { return to_local(direction, v.tangent, v.bitangent, v.normal); }

// Whether the BSDF sends light to wi itself that is not folded away. local: wi in the local basis.
bool has_itself(Vertex v, vec3 wi, vec3 local) {
  return !is_bent(v) || v.plane == v.normal || (local.z > 0.0) == (dot(wi, v.plane) > 0.0);
}

// The mirror image of wi, if the BSDF sends light on wi's side there.
bool has_image(Vertex v, vec3 wi, out vec3 image) {
  if (!is_bent(v)) return false;
  image = to_local(v, wi - 2.0 * dot(wi, v.plane) * v.plane);
  return (image.z > 0.0) == (dot(wi, v.plane) > 0.0) && v.plane != v.normal;
}

// f |cos| for light that the vertex sends to v.wo, and its density. wi must lie on the side that sides_agree() asks for.
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

// Whether f cos / pdf of a drawn direction is the albedo, with no need to round.
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

// The medium that a ray is in after it crossed the surface of a volume.
uint medium_behind(Vertex v) { return v.bsdf.entering ? v.surface.material : kNone; }

// Transmittance of a distance in a medium; a path leaves to infinity inside a medium only through an open mesh.
const float kFarAway = 1e30; // metres; not infinity: 0 * inf
vec3 medium_transmittance(uint medium, float distance_) {
  return medium == kNone ? vec3(1.0) : exp(-fetch_material(medium).attenuation * distance_);
}

#endif
