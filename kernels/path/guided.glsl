// A direction drawn from the guiding field or from the BSDF of a vertex, with the density of both together.
#ifndef WAVEPATH_PATH_GUIDED_GLSL
#define WAVEPATH_PATH_GUIDED_GLSL

#include "kernels/path/guide.glsl"
#include "kernels/vertex.glsl"

// As vertex_sample(), by both techniques. `bsdf_pdf`: of the BSDF alone.
bool guided_sample(Vertex v, Guide guide, float u_choice, vec2 u, out BsdfSample s, out vec3 wi, out float bsdf_pdf) {
  bool delta = false;
  bsdf_pdf = 0.0;
  vec3 wo = to_local(v, v.wo);
  if (!(wo.z > 0.0)) return false;
  Lobes l = lobes_of(v.bsdf, wo);
  bool guided = u_choice < guide.probability;
  if (guided) {
    wi = sample_guide(guide, u);
    s = BsdfSample(to_local(v, wi), vec3(0.0), 0.0, 1.0, false);
    s.transmitted = s.wi.z < 0.0;
    if (has(kFeatureTransmission) && s.transmitted && !v.bsdf.thin) s.eta_scale = l.surface.eta * l.surface.eta;
  } else {
    float u_lobe = min((u_choice - guide.probability) / (1.0 - guide.probability), kOneMinusEpsilon);
    if (!bsdf_sample_direction(v.bsdf, l, wo, u_lobe, u, s, delta)) return false;
    wi = drawn_direction(v, s);
    if (delta) {
      s.weight /= 1.0 - guide.probability;
      return true;
    }
  }
  vec3 value = vertex_eval(v, l, wi, bsdf_pdf);
  s.pdf = guided_pdf(guide, bsdf_pdf, wi);
  if (!(s.pdf > 0.0) || !is_finite(s.pdf)) return false;
  s.weight = value / s.pdf;
  return true;
}

#endif
