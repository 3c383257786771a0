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
  return b;
}

Vertex make_vertex(Surface surface, Material material, vec3 direction) {
  Vertex v;
  v.surface = surface;
  v.material = material;
  v.wo = -direction;
  v.front = dot(surface.geometric_normal, v.wo) >= 0.0;
  v.bumped = bumped_normal(surface, material, v.front);
  v.normal = held_normal(v.bumped, v.wo);
  make_basis(v.normal, v.tangent, v.bitangent);
  vec3 base = base_color(material, surface.uv, surface.color).rgb;
  v.bsdf = make_bsdf(material, surface.uv, base, v.front);
  return v;
}

// A direction must lie on the same side of the real surface as of the shading normal, or light would leak through.
bool sides_agree(Vertex v, vec3 wi) {
  vec3 facing = v.front ? v.surface.geometric_normal : -v.surface.geometric_normal;
  return (dot(wi, facing) > 0.0) == (dot(wi, v.normal) > 0.0);
}

// The medium that a ray is in after it crossed the surface of a volume.
uint medium_behind(Vertex v) { return v.bsdf.entering ? v.surface.material : kNone; }

// Transmittance of a distance in a medium; a path leaves to infinity inside a medium only through an open mesh.
const float kFarAway = 1e30; // metres; not infinity: 0 * inf
vec3 medium_transmittance(uint medium, float distance_) {
  return medium == kNone ? vec3(1.0) : exp(-fetch_material(medium).attenuation * distance_);
}

#endif
