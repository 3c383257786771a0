// A direction drawn from the guiding field or from the BSDF of a vertex, with the density of both together.
#ifndef WAVEPATH_PATH_GUIDED_GLSL
#define WAVEPATH_PATH_GUIDED_GLSL

#include "kernels/path/guide.glsl"
#include "kernels/surface/vertex.glsl"

// Draws a direction like vertex_sample(), by the BSDF or by the guide, one of which u.y picks. Kernels without guiding
// use the BSDF only. `bsdf_pdf`: density by the BSDF alone.
bool guided_sample(Vertex v, Lobes l, Guide guide, float u_side, vec2 u, out BsdfSample s, out vec3 wi,
                   out float bsdf_pdf) {
  bool delta = false;
  bsdf_pdf = 0.0;
  if (has(kFeatureGuide) && take_with_probability(u.y, guide.probability)) {
    wi = sample_map(guide.map, u);
    s = BsdfSample(to_local(v, wi), vec3(0.0), 0.0, 1.0, false, false);
    s.transmitted = is_below(v, wi);
    if (has(kFeatureTransmission) && s.transmitted && !v.bsdf.thin) s.eta_scale = l.surface.eta * l.surface.eta;
  } else {
    if (!bsdf_sample_direction(v.bsdf, l, to_local(v, v.wo), u_side, u, s, delta)) return false;
    wi = drawn_direction(v, s);
    if (delta) {
      if (has(kFeatureGuide)) s.weight /= 1.0 - guide.probability;
      return true;
    }
  }
  vec3 value = vertex_eval(v, l, wi, s.wi, bsdf_pdf);
  s.pdf = has(kFeatureGuide) ? guided_pdf(guide, bsdf_pdf, wi) : bsdf_pdf;
  return weigh_sample(v, value, !has(kFeatureGuide) && weight_is_albedo(v, wi), s);
}

#endif
