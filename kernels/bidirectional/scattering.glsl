// Scattering seen from both ends of a path. Include bindings.glsl with BIND_GEOMETRY and BIND_SURFACES first.
//
// The value is always that of a camera path, which sees the surface from `wo`; so both ends find the same light where
// shading normals or refraction make the two directions differ.
#ifndef WAVEPATH_BIDIRECTIONAL_SCATTERING_GLSL
#define WAVEPATH_BIDIRECTIONAL_SCATTERING_GLSL

#include "kernels/surface/vertex.glsl"

float surface_cosine(Vertex v, vec3 direction) { return abs(dot(v.surface.geometric_normal, direction)); }

// The same point, seen from another direction.
Vertex seen_from(Vertex v, vec3 wo) {
  bool front = dot(v.surface.geometric_normal, wo) >= 0.0;
  if (front != v.front) turn_over(v);
  v.wo = wo;
  v.front = v.bsdf.entering = front;
  set_basis(v);
  return v;
}

// Density with which a light path that comes from `wi` goes on to v.wo.
float reverse_pdf(Vertex v, vec3 wi) {
  Vertex turned = seen_from(v, wi);
  float pdf;
  vertex_eval(turned, v.wo, pdf);
  return pdf;
}

// f |cos| of light from `wi` that goes to v.wo, and the densities with which camera paths find wi and light paths find
// wo.
vec3 scatter_value(Vertex v, vec3 wi, out float forward, out float reverse) {
  forward = reverse = 0.0;
  if (!sides_agree(v, wi)) return vec3(0.0);
  vec3 value = vertex_eval(v, wi, forward);
  if (max_component(value) > 0.0) reverse = reverse_pdf(v, wi);
  return value;
}

#endif
