// The point where a ray hits: surface, material and BSDF, and the medium on either side. Include bindings.glsl with
// BIND_GEOMETRY and BIND_SURFACES first.
#ifndef WAVEPATH_VERTEX_GLSL
#define WAVEPATH_VERTEX_GLSL

#include "kernels/bsdf.glsl"
#include "kernels/surface.glsl"

// Of the path that is being shaded: 0, 1, 2 = its light is red, green, blue once it has met glass that disperses. Kernels
// that do not set it see all glass with the middle ior.
uint path_channel = 1u;

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
  vec3 plane;       // the normal before a map bent it, on wo's side (kFeatureNormalMaps)
  vec3 coat_normal; // world, on wo's side (kLobeCoat)
  vec3 grain;       // world: the direction along which microfacets are stretched, zero if they are not (kLobeAnisotropy)
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
        sample_texture_or_1(kFeatureMetallicRoughnessTextures, material.metallic_roughness_texture, uv);
    b.metallic *= metallic_roughness.b;
    roughness *= metallic_roughness.g;
    b.specular *= sample_texture_or_1(kFeatureSpecularTextures, material.specular_texture, uv).a;
    b.specular_color *= sample_texture_or_1(kFeatureSpecularTextures, material.specular_color_texture, uv).rgb;
  }
  if (has(kFeatureTransmission))
    b.transmission =
        material.transmission * sample_texture_or_1(kFeatureTransmissionTextures, material.transmission_texture, uv).r;
  b.alpha = roughness * roughness;
  b.ior = material.ior;
  b.entering = front;
  b.thin = (material.flags & kMaterialVolume) == 0u;
  b.coat = Coat(0.0, 0.0, vec3(0.0, 0.0, 1.0));
  b.sheen = Sheen(vec3(0.0), 0.0, 0u);
  b.film = Film(0.0, 1.0, 0.0);
  b.stretched_alpha = vec2(b.alpha);
  b.diffuse_through = vec3(0.0);
  b.diffuse_transmission = 0.0;
  b.ggx_table = b.glass_table = kNone;
  b.disperses = false;
  return b;
}

vec4 layer_texture(uint index, vec4 uv) { return index == kNone ? vec4(1.0) : sample_texture(index, uv); }

// Fills in what the material has beyond metallic-roughness: rows of MaterialLayers.
void read_layers(inout Vertex v) {
  uint m = v.surface.material;
  vec4 uv = v.surface.uv;
  if (uses_lobe(kLobeCoat)) {
    vec4 factors = uintBitsToFloat(fetch_layers(m, 1u));
    uvec4 maps = fetch_layers(m, 2u);
    if (factors.x > 0.0) {
      v.bsdf.coat.weight = factors.x * layer_texture(floatBitsToUint(factors.w), uv).r;
      float roughness = factors.y * layer_texture(maps.x, uv).g;
      v.bsdf.coat.alpha = roughness * roughness;
      vec3 n = v.surface.vertex_normal;
      bool reversed = dot(n, v.front ? v.surface.geometric_normal : -v.surface.geometric_normal) < 0.0;
      if (maps.y != kNone && has(kFeatureNormalMaps) && has_tangent(v.surface)) n = mapped_normal(v.surface, n, maps.y, factors.z);
      v.coat_normal = reversed ? -n : n;
    }
  }
  if (uses_lobe(kLobeSheen)) {
    vec4 sheen = uintBitsToFloat(fetch_layers(m, 0u));
    if (max_component(sheen.rgb) > 0.0) {
      uvec4 maps = fetch_layers(m, 2u);
      v.bsdf.sheen.color = sheen.rgb * layer_texture(maps.z, uv).rgb;
      v.bsdf.sheen.roughness = sheen.a * layer_texture(maps.w, uv).a;
      v.bsdf.sheen.table = fetch_layers(m, 8u).z;
    }
  }
  if (uses_lobe(kLobeAnisotropy)) {
    uvec4 words = fetch_layers(m, 3u);
    float strength = uintBitsToFloat(words.x), rotation = uintBitsToFloat(words.y);
    if (strength > 0.0 && has_tangent(v.surface)) {
      vec2 direction = vec2(1.0, 0.0);
      if (words.z != kNone) {
        vec4 map = sample_texture(words.z, uv);
        direction = map.xy * 2.0 - 1.0;
        strength *= map.z;
      }
      direction = mat2(cos(rotation), sin(rotation), -sin(rotation), cos(rotation)) * direction;
      vec3 n = v.surface.vertex_normal;
      vec3 t = safe_normalize(v.surface.tangent.xyz - n * dot(n, v.surface.tangent.xyz), vec3(0.0));
      v.grain = t * direction.x + cross(n, t) * (v.surface.tangent.w * direction.y);
      float across = max(v.bsdf.alpha, kMinAlpha);
      v.bsdf.stretched_alpha = vec2(mix(across, 1.0, strength * strength), across);
    }
  }
  if (uses_lobe(kLobeIridescence)) {
    vec4 film = uintBitsToFloat(fetch_layers(m, 4u));
    if (film.x > 0.0) {
      uvec4 maps = fetch_layers(m, 5u);
      float weight = film.x * layer_texture(maps.x, uv).r;
      v.bsdf.film = Film(weight, film.y, mix(film.z, film.w, layer_texture(maps.y, uv).g));
      if (v.bsdf.film.nanometres <= 0.0) v.bsdf.film.weight = 0.0;
    }
  }
  if (uses_lobe(kLobeDispersion) && !v.bsdf.thin && v.bsdf.ior > 1.0) {
    // The ior falls linearly from blue to red, by (ior - 1) / Abbe number over the range, as KHR_materials_dispersion has it.
    float dispersion = uintBitsToFloat(fetch_layers(m, 5u).z);
    v.bsdf.disperses = dispersion > 0.0 && v.bsdf.transmission > 0.0;
    float half_spread = 0.025 * dispersion * (v.bsdf.ior - 1.0);
    if (v.bsdf.disperses) v.bsdf.ior = max(v.bsdf.ior + (float(path_channel) - 1.0) * half_spread, 1.0);
  }
  if (uses_lobe(kLobeDiffuseTransmission)) {
    vec4 through = uintBitsToFloat(fetch_layers(m, 6u));
    if (through.w > 0.0) {
      uint share_map = fetch_layers(m, 7u).w, color_map = fetch_layers(m, 8u).x;
      v.bsdf.diffuse_through = through.rgb * layer_texture(color_map, uv).rgb;
      v.bsdf.diffuse_transmission = through.w * layer_texture(share_map, uv).a;
    }
  }
  if (uses_lobe(kLobeMultiple)) {
    uvec4 tables = fetch_layers(m, 8u);
    v.bsdf.ggx_table = tables.y;
    v.bsdf.glass_table = tables.w;
  }
}

// The local basis for wo, and what the BSDF has in it.
void set_basis(inout Vertex v) {
  v.normal = held_normal(v.bumped, v.wo);
  make_basis(v.normal, v.tangent, v.bitangent);
  if (has_lobe(kLobeAnisotropy) && is_stretched(v.bsdf)) {
    v.tangent = safe_normalize(v.grain - v.normal * dot(v.normal, v.grain), v.tangent);
    v.bitangent = cross(v.normal, v.tangent);
  }
  if (has_lobe(kLobeCoat) && v.bsdf.coat.weight > 0.0)
    v.bsdf.coat.normal = to_local(held_normal(v.coat_normal, v.wo), v.tangent, v.bitangent, v.normal);
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
  v.plane = v.coat_normal = v.bumped;
  if (has(kFeatureNormalMaps)) {
    vec3 n = surface.vertex_normal;
    v.plane = dot(n, v.front ? surface.geometric_normal : -surface.geometric_normal) < 0.0 ? -n : n;
  }
  v.grain = vec3(0.0);
  if (kLobes != 0u) read_layers(v);
  set_basis(v);
  return v;
}

// A direction must lie on the same side of the real surface as of the shading normal, or light would leak through.
bool sides_agree(Vertex v, vec3 wi) {
  vec3 facing = v.front ? v.surface.geometric_normal : -v.surface.geometric_normal;
  return (dot(wi, facing) > 0.0) == (dot(wi, v.normal) > 0.0);
}

// ---- scattering in world space --------------------------------------------------------------------------------------
// Half of what a bent normal scatters may head below the surface that the map stands for, where no light is. It is mirrored
// up at that surface: value and density of a direction are those of the BSDF for it and for its mirror image, so that a
// white surface returns all light whatever its map (cutting these directions off returned 57 % in a strong map). Mirrors
// are left as they are: what is folded could not be followed back from the light.

vec3 to_local(Vertex v, vec3 direction) { return to_local(direction, v.tangent, v.bitangent, v.normal); }

bool is_bent(Vertex v) { return has(kFeatureNormalMaps) && v.material.normal_texture != kNone; }

// The mirror image of wi, if the BSDF sends light on wi's side there.
bool has_image(Vertex v, vec3 wi, out vec3 image) {
  if (!is_bent(v)) return false;
  image = to_local(v, wi - 2.0 * dot(wi, v.plane) * v.plane);
  return (image.z > 0.0) == (dot(wi, v.plane) > 0.0) && v.plane != v.normal;
}

// f |cos| for light that the vertex sends to v.wo, and its density. wi must lie on the side that sides_agree() asks for.
vec3 vertex_eval(Vertex v, Lobes l, vec3 wi, vec3 local, out float pdf) {
  vec3 wo = to_local(v, v.wo), image;
  vec3 value = eval_lobes(v.bsdf, l, wo, local, pdf);
  if (has_image(v, wi, image)) {
    float image_pdf;
    value += eval_lobes(v.bsdf, l, wo, image, image_pdf);
    pdf += image_pdf;
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
  bool below = is_bent(v) && s.pdf >= 0.0 && (dot(wi, v.plane) > 0.0) != (s.wi.z > 0.0);
  if (!below) return wi;
  wi = normalize(wi - 2.0 * dot(wi, v.plane) * v.plane);
  s.wi = to_local(v, wi);
  return wi;
}

// Draws a direction; false if the path ends here.
bool vertex_sample(Vertex v, float u_lobe, vec2 u, out BsdfSample s, out vec3 wi) {
  if (!has(kFeatureNormalMaps)) {
    if (!bsdf_sample(v.bsdf, to_local(v, v.wo), u_lobe, u, s)) return false;
    wi = normalize(to_world(s.wi, v.tangent, v.bitangent, v.normal));
    return true;
  }
  s = BsdfSample(vec3(0.0, 0.0, 1.0), vec3(0.0), 0.0, 1.0, false);
  vec3 wo = to_local(v, v.wo);
  if (!(wo.z > 0.0)) return false;
  Lobes l = lobes_of(v.bsdf, wo);
  bool delta;
  if (!bsdf_sample_direction(v.bsdf, l, wo, u_lobe, u, s, delta)) return false;
  wi = drawn_direction(v, s);
  if (delta) return true;
  vec3 image, value = vertex_eval(v, l, wi, s.wi, s.pdf);
  if (!(s.pdf > 0.0) || !is_finite(s.pdf)) return false;
  bool cancels = is_lambert(v.bsdf) && kHemisphere == kHemisphereCosine && !has_image(v, wi, image); // see bsdf_sample()
  s.weight = cancels ? v.bsdf.base_color : value / s.pdf;
  return true;
}

// The medium that a ray is in after it crossed the surface of a volume.
uint medium_behind(Vertex v) { return v.bsdf.entering ? v.surface.material : kNone; }

// Transmittance of a distance in a medium; a path leaves to infinity inside a medium only through an open mesh.
const float kFarAway = 1e30; // metres; not infinity: 0 * inf
vec3 medium_transmittance(uint medium, float distance_) {
  return medium == kNone ? vec3(1.0) : exp(-fetch_material(medium).attenuation * distance_);
}

#endif
