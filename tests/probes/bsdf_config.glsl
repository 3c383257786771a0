// What the BSDF probes share: a material, the direction it is seen from, the surface that it lies on, and the region of
// directions that is histogrammed.
#ifndef WAVEPATH_TESTS_BSDF_CONFIG_GLSL
#define WAVEPATH_TESTS_BSDF_CONFIG_GLSL

#include "kernels/surface/bsdf.glsl"

// Bound by the probe: albedo tables, GGX first, then sheen, then glass from outside and inside.
layout(set = 0, binding = BIND_TABLES, std430) readonly buffer Tables { vec4 tables[]; };
vec4 fetch_table(uint texel) { return tables[texel]; }

struct Config {
  vec3 base_color;
  float metallic;
  vec3 specular_color;
  float specular;
  float alpha;
  float transmission;
  float ior;
  uint flags; // 1: entering, 2: thin
  vec4 wo;
  vec3 sheen_color;
  float sheen_roughness;
  vec3 coat_normal;
  float coat;
  float coat_alpha;
  float film; // weight
  float film_ior;
  float film_nanometres;
  vec3 diffuse_through;
  float diffuse_transmission;
  vec2 stretched_alpha; // 0: alpha
  vec2 pad;
  vec3 plane; // the normal before a map bent it to +Z,
  uint bent;  // if one did
  vec4 facet; // the normal of the triangle
  vec4 window; // axis and half width of a square window around it; zero width: the whole sphere
};

Bsdf bsdf_of(Config c) {
  Coat coat = Coat(c.coat, c.coat_alpha, c.coat_normal);
  Sheen sheen = Sheen(c.sheen_color, c.sheen_roughness, kTableTexels);
  vec2 stretched = c.stretched_alpha.x > 0.0 ? c.stretched_alpha : vec2(c.alpha);
  return Bsdf(c.base_color, c.metallic, c.specular_color, c.specular, c.alpha, c.transmission, c.ior,
              (c.flags & 1u) != 0u, (c.flags & 2u) != 0u, 0u, 2u * kTableTexels, coat, sheen,
              Film(c.film, c.film_ior, c.film_nanometres), stretched, c.diffuse_through, c.diffuse_transmission, false);
}

// A vertex as kernels/surface/vertex.glsl has it, in a world whose axes are those of the local basis.
struct Facet {
  vec3 geometric_normal;
};
struct Map {
  uint normal_texture;
};
struct Vertex {
  Facet surface;
  Map material;
  bool front;
  vec3 wo, normal, tangent, bitangent, plane;
  Bsdf bsdf;
};
#include "kernels/surface/world_scattering.glsl"

Vertex vertex_of(Config c) {
  return Vertex(Facet(c.facet.xyz), Map(c.bent != 0u ? 0u : kNone), true, c.wo.xyz, vec3(0.0, 0.0, 1.0),
                vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), c.plane, bsdf_of(c));
}

// What light from wi gives, and the density with which it is drawn, as kernels/path/shade.comp has both.
vec3 value_of(Vertex v, vec3 wi, out float pdf) {
  pdf = 0.0;
  return sides_agree(v, wi) ? vertex_eval(v, wi, pdf) : vec3(0.0);
}

// Position of a direction in the region, in [0,1)^2; false if it lies outside.
bool region_position(Config c, vec3 w, out vec2 position) {
  if (c.window.w == 0.0) {
    position = vec2(0.5 * w.z + 0.5, fract(atan2_exact(w.y, w.x) * 0.5 * kInvPi));
  } else {
    vec3 tangent, bitangent;
    make_basis(c.window.xyz, tangent, bitangent);
    position = 0.5 * vec2(dot(w, tangent), dot(w, bitangent)) / c.window.w + 0.5;
    if (dot(w, c.window.xyz) <= 0.0) return false;
  }
  return all(greaterThanEqual(position, vec2(0.0))) && all(lessThan(position, vec2(1.0)));
}

#endif
