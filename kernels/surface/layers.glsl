// Layers on and beside the metallic-roughness model of bsdf.glsl: coat over (sheen over f), films on its interfaces,
// stretched microfacets, light that the diffuse base transmits. coat.glsl and sheen.glsl compute the light that a layer
// lets pass. Only LAYERED kernels include this file; the others include no_layers.glsl, which has the same functions
// for materials without layers.
#ifndef WAVEPATH_LAYERS_GLSL
#define WAVEPATH_LAYERS_GLSL

#include "kernels/surface/bsdf_types.glsl"
#include "kernels/surface/microfacet.glsl"

// Defined in bsdf.glsl.
vec3 dielectric_reflectance(Bsdf b, Interface surface, float c);
float base_passes(Bsdf b, Interface surface, float mu);

// No ||, of which glslang makes a branch.
const bool kLayers = (kLobes & (kLobeCoat | kLobeSheen | kLobeDiffuseTransmission)) != 0u;

bool is_coated(Bsdf b) { return has_lobe(kLobeCoat) && b.coat.weight > 0.0; }
bool has_sheen(Bsdf b) { return has_lobe(kLobeSheen) && max_component(b.sheen.color) > 0.0; }
bool is_stretched(Bsdf b) { return has_lobe(kLobeAnisotropy) && b.stretched_alpha.x != b.stretched_alpha.y; }
bool is_mirror(Bsdf b) { return b.alpha < kMinAlpha && !is_stretched(b); }

bool has_cover(Bsdf b) { return is_coated(b) || has_sheen(b); }
bool has_wide_layers(Bsdf b) {
  return has_cover(b) || (has_lobe(kLobeDiffuseTransmission) && b.diffuse_transmission > 0.0);
}
bool has_rough_cover(Bsdf b) { return (is_coated(b) && b.coat.alpha >= kMinAlpha) || has_sheen(b); }

// True if nothing but the interface lies on the diffuse base.
bool has_plain_base(Bsdf b) { return !has_wide_layers(b) && (!has_lobe(kLobeIridescence) || b.film.weight == 0.0); }

// Fraction of the diffuse base that stays on its side.
float diffuse_kept(Bsdf b) { return has_lobe(kLobeDiffuseTransmission) ? 1.0 - b.diffuse_transmission : 1.0; }

// ---- microfacets, stretched or not ----------------------------------------------------------------------------------

float facet_distribution(Bsdf b, vec3 h) {
  return is_stretched(b) ? ggx_distribution(h, b.stretched_alpha) : ggx_distribution(h, b.alpha);
}
float facet_visibility(Bsdf b, vec3 wo, vec3 wi) {
  return is_stretched(b) ? smith_visibility(wo, wi, b.stretched_alpha) : smith_visibility(wo, wi, b.alpha);
}
float facet_reflected_pdf(Bsdf b, vec3 wo, vec3 h) {
  return is_stretched(b) ? ggx_reflected_pdf(wo, h, b.stretched_alpha) : ggx_reflected_pdf(wo, h, b.alpha);
}
vec3 sample_facet(Bsdf b, vec3 wo, vec2 u) {
  return ggx_sample_visible_normal(wo, is_stretched(b) ? b.stretched_alpha : vec2(b.alpha), u);
}

// ---- thin films -----------------------------------------------------------------------------------------------------

// The film's fraction of what a base of normal reflectance f0 reflects. From inside a body, the film is met at the
// angle at which the light leaves, so that both ways have one reflectance.
vec3 with_film(Bsdf b, Interface surface, vec3 f0, vec3 plain, float c) {
  if (!has_lobe(kLobeIridescence) || b.film.weight == 0.0) return plain;
  float outside2 = surface.eta < 1.0 ? 1.0 - (1.0 - c * c) / (surface.eta * surface.eta) : c * c;
  if (outside2 <= 0.0) return plain;
  return mix(plain, film_reflectance(b.film, f0, sqrt(outside2)), b.film.weight);
}

// The share that the film lets pass to the diffuse base, if that is less.
float film_passes(Bsdf b, Interface surface, float mu, float passes) {
  if (!has_lobe(kLobeIridescence) || b.film.weight == 0.0) return passes;
  float c = is_blurred(surface, b.alpha) ? blurred_cosine(surface, mu, b.alpha) : mu;
  return min(passes, 1.0 - max_component(dielectric_reflectance(b, surface, c)));
}

// ---- all together ---------------------------------------------------------------------------------------------------

void clear_layers(inout Lobes l) { l.sheen_passed = l.coat_passed = l.coat_passed_mean = 1.0; }

// Sets the fractions of light that the layers pass, and those that they scatter themselves. `diffuse`: fraction of the
// diffuse base.
void add_layers(Bsdf b, vec3 wo, float diffuse, inout Lobes l, inout LobeWeights weights) {
  if (!kLayers) return;
  if (has_lobe(kLobeDiffuseTransmission)) {
    float lost = diffuse * b.diffuse_transmission;
    weights.reflected -= lost;
    weights.through += lost * luminance(b.diffuse_through) / max(luminance(b.base_color), 1e-6);
  }
  bool outside = is_outside(b, 1.0);
  if (has_sheen(b) && outside) {
    l.sheen_passed = sheen_passes(b.sheen, wo);
    weights.facets *= l.sheen_passed;
    weights.through *= l.sheen_passed;
    weights.reflected = weights.reflected * l.sheen_passed +
                       luminance(b.sheen.color) * (1.0 - l.sheen_passed) / max_component(b.sheen.color);
  }
  if (is_coated(b)) {
    l.coat_passed_mean = coat_passes_mean(b.coat);
    if (outside) {
      l.coat_passed = coat_passes(b.coat, wo);
      weights.facets *= l.coat_passed, weights.reflected *= l.coat_passed, weights.through *= l.coat_passed;
      weights.coat = 1.0 - l.coat_passed;
    }
  }
}

// Fractions that the layers pass: of light that the facets send from wo to wi, and of light that the diffuse base
// sends. Directions inside a body are below the layers.
float layers_pass(Bsdf b, Lobes l, vec3 wi) {
  if (!kLayers) return 1.0;
  float passed = 1.0;
  bool outside = is_outside(b, wi.z);
  if (has_sheen(b)) passed = outside ? min(l.sheen_passed, sheen_passes(b.sheen, wi)) : l.sheen_passed;
  if (is_coated(b)) passed *= outside ? min(l.coat_passed, coat_passes(b.coat, wi)) : l.coat_passed;
  return passed;
}
float layers_pass_diffuse(Bsdf b, Lobes l, vec3 wi) {
  if (!is_coated(b) || !is_outside(b, 1.0)) return layers_pass(b, l, wi);
  float passed = l.coat_passed * coat_passes(b.coat, wi) / l.coat_passed_mean;
  return has_sheen(b) ? passed * min(l.sheen_passed, sheen_passes(b.sheen, wi)) : passed;
}

// Light that the diffuse base scatters to the other side, in place of its own colour; the coupling at both interfaces
// is that of reflection. mu: cosine there.
vec3 eval_diffuse_through(Bsdf b, Lobes l, float mu) {
  if (!has_lobe(kLobeDiffuseTransmission) || b.diffuse_transmission == 0.0) return vec3(0.0);
  float coupling = l.base_coupling * base_passes(b, l.surface, mu);
  return b.diffuse_through * (b.diffuse_transmission * coupling * kInvPi * mu);
}

// Adds what coat and sheen reflect on wo's side, and the density of the coat's draws.
void add_cover(Bsdf b, Lobes l, vec3 wo, vec3 wi, inout vec3 value, inout float pdf) {
  if (!is_outside(b, 1.0)) return;
  float coat_passed = 1.0, lobe_pdf;
  if (is_coated(b)) {
    coat_passed = min(l.coat_passed, coat_passes(b.coat, wi));
    if (b.coat.alpha >= kMinAlpha) {
      value += eval_coat(b.coat, wo, wi, lobe_pdf);
      pdf += l.coat_probability * lobe_pdf;
    }
  }
  if (has_sheen(b)) value += b.sheen.color * (coat_passed * eval_sheen(b.sheen.roughness, wo, wi));
}

// Draws a direction from the coat; as sample_facets().
bool draw_from_coat(Bsdf b, Lobes l, vec3 wo, vec2 u, inout BsdfSample s, out bool delta) {
  delta = b.coat.alpha < kMinAlpha;
  if (!sample_coat(b.coat, wo, u, delta, s.wi) || !(s.wi.z > 0.0)) return false;
  if (delta) s.weight = vec3(coat_fresnel(b.coat, dot(wo, b.coat.normal)) / l.coat_probability);
  return true;
}

// Adds the mirror reflection of a smooth coat to that of the surface below, if that has one; one ray serves both.
// Returns true if there is a mirror reflection.
bool mirror_in_coat(Bsdf b, vec3 wo, bool mirrors, inout vec3 reflectance, inout vec3 mirrored) {
  if (!is_coated(b) || b.coat.alpha >= kMinAlpha || !is_outside(b, 1.0)) return mirrors;
  float c = dot(wo, b.coat.normal);
  reflectance = (mirrors ? reflectance : vec3(0.0)) + coat_fresnel(b.coat, c);
  if (!mirrors) mirrored = 2.0 * c * b.coat.normal - wo;
  return mirrored.z > 0.0;
}

#endif
