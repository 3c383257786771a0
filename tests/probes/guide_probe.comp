// Evaluates kernels/path/guide.glsl on a field: one function by mode (wave.bounce).
#version 460
#extension GL_GOOGLE_include_directive : require
#define BIND_GUIDE
#include "kernels/path/bindings.glsl"
#include "kernels/path/guide.glsl"

Bsdf black_plain() {
  Bsdf b;
  b.base_color = b.specular_color = vec3(0.0);
  b.metallic = b.specular = b.transmission = 0.0;
  b.alpha = 1.0, b.ior = 1.5;
  b.entering = b.thin = true;
  b.ggx_table = b.glass_table = kNone;
  return b;
}

layout(local_size_x = kWorkgroupSize) in;
struct Element {
  vec4 a, b;
};
layout(set = 0, binding = kBindFilm, std430) buffer Elements { Element elements[]; };

// What is asked for here is the leaf alone, not how often a surface would draw from it.
Guide leaf_at(vec3 position) {
  Lobes none;
  none.diffuse_probability = none.facet_probability = 0.0;
  return find_guide(none, 1.0, position);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= wave.pixel_count) return;
  Element e = elements[i];
  Guide guide = leaf_at(e.a.xyz);
  if (wave.bounce == 0u) { // place a.xyz, direction b.xyz -> b.w: density
    e.b.w = map_pdf(guide.map, e.b.xyz);
  } else { // place a.xyz, u in b.xy -> b: direction, density
    e.b.xyz = sample_map(guide.map, e.b.xy);
    e.b.w = map_pdf(guide.map, e.b.xyz);
  }
  e.a.w = float(guide.map / kGuideMapTexels);
  elements[i] = e;
}
