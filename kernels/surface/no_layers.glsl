// The functions of layers.glsl for materials that have no layers.
#ifndef WAVEPATH_NO_LAYERS_GLSL
#define WAVEPATH_NO_LAYERS_GLSL

#include "kernels/surface/bsdf_types.glsl"
#include "kernels/surface/microfacet.glsl"

const bool kLayers = false;

bool is_mirror(Bsdf b) { return b.alpha < kMinAlpha; }
bool is_stretched(Bsdf b) { return false; }
bool has_cover(Bsdf b) { return false; }
bool has_wide_layers(Bsdf b) { return false; }
bool has_rough_cover(Bsdf b) { return false; }
bool has_plain_base(Bsdf b) { return true; }
float diffuse_kept(Bsdf b) { return 1.0; }

float facet_distribution(Bsdf b, vec3 h) { return ggx_distribution(h, b.alpha); }
float facet_visibility(Bsdf b, vec3 wo, vec3 wi) { return smith_visibility(wo, wi, b.alpha); }
float facet_reflected_pdf(Bsdf b, vec3 wo, vec3 h) { return ggx_reflected_pdf(wo, h, b.alpha); }
vec3 sample_facet(Bsdf b, vec3 wo, vec2 u) { return ggx_sample_visible_normal(wo, b.alpha, u); }

vec3 with_film(Bsdf b, Interface surface, vec3 f0, vec3 plain, float c) { return plain; }
float film_passes(Bsdf b, Interface surface, float mu, float passes) { return passes; }

void clear_layers(inout Lobes l) {}
void add_layers(Bsdf b, vec3 wo, float diffuse, inout Lobes l, inout LobeWeights weights) {}
float layers_pass(Bsdf b, Lobes l, vec3 wi) { return 1.0; }
float layers_pass_diffuse(Bsdf b, Lobes l, vec3 wi) { return 1.0; }
vec3 eval_diffuse_through(Bsdf b, Lobes l, float mu) { return vec3(0.0); }
void add_cover(Bsdf b, Lobes l, vec3 wo, vec3 wi, inout vec3 value, inout float pdf) {}
bool draw_from_coat(Bsdf b, Lobes l, vec3 wo, vec2 u, inout BsdfSample s, out bool delta) {
  delta = false;
  return false;
}
bool mirror_in_coat(Bsdf b, vec3 wo, bool mirrors, inout vec3 reflectance, inout vec3 mirrored) { return mirrors; }

#endif
