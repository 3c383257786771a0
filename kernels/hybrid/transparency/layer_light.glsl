// What a layer sends to the eye, by a function as cheap as real-time renderers have it: emission, the light of one
// light sample without its shadow, and the ambient term. Include bindings.glsl with BIND_GEOMETRY, BIND_SURFACES,
// BIND_LIGHTS, BIND_ENVIRONMENT and BIND_HYBRID first.
#ifndef WAVEPATH_LAYER_LIGHT_GLSL
#define WAVEPATH_LAYER_LIGHT_GLSL

#include "kernels/base/dimensions.glsl"
#include "kernels/light/emission.glsl"
#include "kernels/hybrid/hybrid.glsl"
#include "kernels/surface/ray_cone.glsl"
#include "kernels/surface/vertex.glsl"

// Numbers that the opaque surface behind does not use.
const uint kLayerBounce = 2u;

vec3 layer_direct(Vertex v, uvec2 pixel) {
  LightSample light = sample_light(
      v.surface.position, sample_bits(hybrid_sampler(pixel), bounce_dimension(kLayerBounce) + kDimensionLight));
  if (!(light.pdf > 0.0) || !sides_agree(v, light.direction)) return vec3(0.0);
  if (v.bsdf.transmission > 0.0 && is_below(v, light.direction)) return vec3(0.0); // is seen behind it, as all there
  float bsdf_pdf;
  return vertex_eval(v, light.direction, bsdf_pdf) * light.radiance / light.pdf;
}

// Radiance of the surface as if it were opaque, and its opacity.
vec4 layer_light(Hit hit, uvec2 pixel, vec3 origin, vec3 direction) {
  Surface surface = fetch_surface(hit);
  Material material = fetch_material(surface.material);
  open_cone(hit, surface.position - origin);
  vec4 base = base_color(material, surface.uv, surface.color);
  float alpha = opacity(material, base.a);
  if ((material.flags & kMaterialUnlit) != 0u) return vec4(base.rgb, alpha);
  Vertex v = make_vertex(surface, material, direction);
  vec3 light = surface_emission(surface, material, v.front);
  close_cone();
  if ((hybrid.flags & kHybridAmbient) != 0u)
    light += base.rgb * ((1.0 - v.bsdf.metallic) * (1.0 - v.bsdf.transmission)) * hybrid.ambient;
  if (frame.max_depth > 0u && frame.light_count > 0u) light += layer_direct(v, pixel);
  return vec4(is_finite(light) ? light : vec3(0.0), alpha);
}

#endif
