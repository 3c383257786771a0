// The point where a ray hits: surface, material and BSDF, and the medium on either side. Include bindings.glsl with
// BIND_GEOMETRY and BIND_SURFACES first.
#ifndef WAVEPATH_VERTEX_GLSL
#define WAVEPATH_VERTEX_GLSL

#include "kernels/surface/bsdf.glsl"
#include "kernels/surface/surface.glsl"

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
  vec3 grain;       // world: the direction along which microfacets are stretched, zero if they are not
                    // (kLobeAnisotropy)
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
#include "kernels/surface/vertex_layers.glsl"
#else
void read_layers(inout Vertex v) {}
void set_layer_basis(inout Vertex v) {}
void turn_layers(inout Vertex v) {}
bool lets_light_pass(Vertex v) { return v.bsdf.transmission > 0.0; }
#endif
#include "kernels/surface/world_scattering.glsl"

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
  // Surfaces that transmit light keep their facets, since both sides of a body must agree.
  if (kTerminator == kTerminatorSmooth && !lets_light_pass(v)) lift_surface(v.surface, v.front);
  return v;
}

// The medium that a ray is in after it crossed the surface of a volume.
uint medium_behind(Vertex v) { return v.bsdf.entering ? v.surface.material : kNone; }

// Transmittance of a distance in a medium; a path leaves to infinity inside a medium only through an open mesh.
const float kFarAway = 1e30; // metres; not infinity: 0 * inf
vec3 medium_transmittance(uint medium, float distance_) {
  return medium == kNone ? vec3(1.0) : exp(-fetch_material(medium).attenuation * distance_);
}

#endif
