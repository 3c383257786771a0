// The surface model of glTF 2.0: metallic-roughness with KHR_materials_specular, _ior, _transmission and _volume. What
// _clearcoat, _sheen, _anisotropy, _iridescence and _diffuse_transmission add to it is in layers.glsl.
//
// f = metallic * conductor + (1 - metallic) * dielectric, where the dielectric is an interface over a mix of a diffuse
// base and transmission. What the interface reflects at a microfacet, the transmission below it lacks: (1 - max
// F(v.h)), as in glTF's appendix B. The diffuse base is coupled by T(o) T(i) / mean T instead, T = 1 - albedo of the
// interface. The appendix's 1 - F(v.h) returns up to 1.7 times the light that arrives, at grazing angles; this is
// reciprocal too, keeps energy, and is exact for a smooth coat.
//
// Directions are unit vectors in the local basis: z = shading normal, turned to wo's side, so wo.z > 0; they point away
// from the surface. Radiance is transported: refraction scales it by 1 / eta^2. Microfacets narrower than alpha = 1e-4
// (roughness 0.01) cannot be told from a mirror in single precision, so they are one: "delta".
#ifndef WAVEPATH_BSDF_GLSL
#define WAVEPATH_BSDF_GLSL

#include "kernels/surface/bsdf_types.glsl"
#include "kernels/surface/multiple.glsl"
#ifdef LAYERED
#include "kernels/surface/layers.glsl"
#else
#include "kernels/surface/no_layers.glsl"
#endif

// Written without ||, which glslang compiles to a branch.
const bool kThrough = (kLobes & (kLobeDiffuseTransmission | kLobeMultiple)) != 0u;

vec3 dielectric_reflectance(Bsdf b, Interface surface, float c) {
  return with_film(b, surface, surface.f0, fresnel_dielectric(surface, c), c);
}

// Fraction reflected at a microfacet that wo meets with cosine c.
vec3 facet_reflectance(Bsdf b, Interface surface, float c) {
  vec3 conductor = with_film(b, surface, b.base_color, fresnel_conductor(b.base_color, c), c);
  return dielectric_reflectance(b, surface, c) * (1.0 - b.metallic) + conductor * b.metallic;
}

// Fraction transmitted there, before the 1/eta^2 of radiance.
vec3 facet_transmittance(Bsdf b, Interface surface, float c) {
  if (!has(kFeatureTransmission)) return vec3(0.0);
  float passed = (1.0 - b.metallic) * b.transmission * (1.0 - max_component(dielectric_reflectance(b, surface, c)));
  return passed * b.base_color;
}

// A thin smooth pane: light that it transmits goes straight on, so that shadow rays may pass.
bool is_pane(Bsdf b) {
  return has(kFeatureTransmission) && b.thin && is_mirror(b) && b.transmission > 0.0 && !has_cover(b);
}

// A wall between bodies of the same ior, which light passes in the same way. Its roughness bends nothing.
bool is_unbending_wall(Bsdf b) {
  return has(kFeatureTransmission) && !b.thin && b.ior == 1.0 && b.transmission > 0.0 && !has_cover(b);
}

// Transmittance of either at this cosine: the throughput of the delta lobe that sample_facets() draws, over all its
// draws.
vec3 pane_transmittance(Bsdf b, float c) { return facet_transmittance(b, surface_of(b), c); }

// Probability of reflecting rather than transmitting at the microfacet.
float reflect_probability(vec3 reflectance, vec3 transmittance) {
  float r = luminance(reflectance), t = luminance(transmittance);
  return t > 0.0 ? r / (r + t) : 1.0;
}

bool is_lambert(Bsdf b) {
  if (has_wide_layers(b)) return false;
  return !kMicrofacets || (b.metallic == 0.0 && b.transmission == 0.0 && (b.specular == 0.0 || b.ior == 1.0));
}

// Fraction of light along a direction that gets to the diffuse base, or from it.
float base_passes(Bsdf b, Interface surface, float mu) {
  return film_passes(b, surface, mu, interface_transmittance(surface, mu, b.alpha));
}

// ---- more than one bounce between microfacets: see multiple.glsl ----------------------------------------------------

// Table of the missing energy of the microfacets on wo's side, and on the other.
bool is_body(Bsdf b) { return has(kFeatureTransmission) && !b.thin && b.transmission > 0.0 && b.metallic < 1.0; }
uint own_table(Bsdf b) { return !is_body(b) ? b.ggx_table : b.glass_table + (b.entering ? 0u : kTableTexels); }
uint other_table(Bsdf b) { return !is_body(b) ? b.ggx_table : b.glass_table + (b.entering ? kTableTexels : 0u); }

// Adds its lobes for wo.
void add_multiple(Bsdf b, vec3 wo, inout Lobes l, inout LobeWeights weights) {
  if (!has_lobe(kLobeMultiple) || l.delta_reflection || b.ggx_table == kNone) return;
  if (is_stretched(b)) return; // there is no table for stretched facets, and any round one would return too much
  vec4 average = table_average(own_table(b), sqrt(b.alpha));
  float missing = average.x, missing_there = is_body(b) ? average.y : missing;
  if (missing <= kLeastMissing || missing_there <= kLeastMissing) return;
  float lacking = facets_lack(own_table(b), wo, b.alpha);
  float glass = has(kFeatureTransmission) ? (1.0 - b.metallic) * b.transmission : 0.0;
  float passes = 0.0;
  if (glass > 0.0) {
    float ior = max(b.ior, 1.0);
    passes = b.thin ? 1.0 - interface_mean(l.surface, 0.0)
                    : body_passes(average, b.entering ? 1.0 : ior, b.entering ? ior : 1.0);
  }
  vec3 returned = b.metallic * metal_returns(b.base_color, missing) + glass * (1.0 - passes);
  l.multiple = returned * (lacking / (kPi * missing));
  l.multiple_through = b.base_color * (glass * passes * lacking / (kPi * missing_there));
  weights.reflected += luminance(l.multiple) * (kPi * missing);
  weights.through += luminance(l.multiple_through) * (kPi * missing_there);
}

// Light that the microfacets reflect after more than one bounce.
vec3 eval_multiple(Bsdf b, Lobes l, vec3 wi) {
  if (!has_lobe(kLobeMultiple) || max_component(l.multiple) <= 0.0) return vec3(0.0);
  return l.multiple * (facets_lack(own_table(b), wi, b.alpha) * wi.z);
}

// ---- the lobes ------------------------------------------------------------------------------------------------------

void set_probabilities(LobeWeights weights, inout Lobes l) {
  float wide = weights.reflected + weights.through, all_ = weights.coat + weights.facets + wide;
  l.coat_probability = all_ > 0.0 ? weights.coat / all_ : 0.0;
  l.facet_probability = all_ > 0.0 ? (wide > 0.0 ? weights.facets / all_ : 1.0 - l.coat_probability) : 0.0;
  l.diffuse_probability = wide > 0.0 ? max(1.0 - l.coat_probability - l.facet_probability, 0.0) : 0.0;
  l.through = wide > 0.0 ? weights.through / wide : 0.0;
}

Lobes lobes_of(Bsdf b, vec3 wo) {
  Lobes l;
  l.diffuse = b.base_color;
  l.diffuse_probability = luminance(b.base_color) > 0.0 ? 1.0 : 0.0;
  l.facet_probability = l.coat_probability = l.through = 0.0;
  l.base_coupling = 1.0;
  l.multiple = l.multiple_through = vec3(0.0);
  clear_layers(l);
  l.delta_reflection = l.delta_transmission = false;
  if (!kMicrofacets) return l;

  l.surface = surface_of(b);
  l.delta_reflection = is_mirror(b);
  l.delta_transmission = l.delta_reflection || (!b.thin && abs(l.surface.eta - 1.0) < kMinEtaStep);
  float below = base_passes(b, l.surface, wo.z);
  float base = (1.0 - b.metallic) * (1.0 - b.transmission);
  float mean = l.surface.eta < 1.0 ? 0.0 : interface_mean(l.surface, b.alpha);
  l.base_coupling = base * below / max(1.0 - mean, 1e-6);
  l.diffuse = b.base_color * l.base_coupling;
  float facets = luminance(facet_reflectance(b, l.surface, wo.z)) + luminance(facet_transmittance(b, l.surface, wo.z));
  float diffuse = luminance(b.base_color) * base * below;
  LobeWeights weights = LobeWeights(0.0, facets, diffuse, 0.0);
  add_multiple(b, wo, l, weights);
  add_layers(b, wo, diffuse, l, weights);
  set_probabilities(weights, l);
  return l;
}

// ---- evaluation -------------------------------------------------------------------------------------------------

vec3 eval_diffuse(Bsdf b, Lobes l, vec3 wi, out float pdf) {
  pdf = kHemisphere == kHemisphereUniform ? warp_uniform_hemisphere_pdf() : warp_cosine_hemisphere_pdf(wi.z);
  vec3 value = l.diffuse * (kInvPi * wi.z);
  value *= diffuse_kept(b);
  return kMicrofacets ? value * base_passes(b, l.surface, wi.z) : value;
}

// Value of the wide lobes that go through the surface: of a diffuse base, and of rough glass.
vec3 eval_through(Bsdf b, Lobes l, vec3 wi, out float pdf) {
  pdf = 0.0;
  if (!kThrough || l.through <= 0.0) return vec3(0.0);
  float mu = -wi.z;
  pdf = kHemisphere == kHemisphereUniform ? warp_uniform_hemisphere_pdf() : warp_cosine_hemisphere_pdf(mu);
  vec3 value = eval_diffuse_through(b, l, mu);
  if (has_lobe(kLobeMultiple) && max_component(l.multiple_through) > 0.0) {
    float scale = b.thin ? 1.0 : 1.0 / (l.surface.eta * l.surface.eta); // scale of radiance
    value += l.multiple_through * (facets_lack(other_table(b), wi, b.alpha) * mu * scale);
  }
  return value;
}

vec3 eval_reflection(Bsdf b, Interface surface, vec3 wo, vec3 wi, out float pdf) {
  vec3 h = normalize(wo + wi);
  float c = dot(wo, h);
  vec3 reflectance = facet_reflectance(b, surface, c);
  pdf = facet_reflected_pdf(b, wo, h) * reflect_probability(reflectance, facet_transmittance(b, surface, c));
  return reflectance * (facet_distribution(b, h) * facet_visibility(b, wo, wi) * wi.z);
}

// Thin walls scatter as reflection does, mirrored to the other side (KHR_materials_transmission).
vec3 eval_thin_transmission(Bsdf b, Interface surface, vec3 wo, vec3 wi, out float pdf) {
  vec3 mirrored = vec3(wi.xy, -wi.z);
  vec3 h = normalize(wo + mirrored);
  float c = dot(wo, h);
  vec3 transmittance = facet_transmittance(b, surface, c);
  float reflected = reflect_probability(facet_reflectance(b, surface, c), transmittance);
  pdf = facet_reflected_pdf(b, wo, h) * (1.0 - reflected);
  return transmittance * (facet_distribution(b, h) * facet_visibility(b, wo, wi) * mirrored.z);
}

// Walter et al. 2007. The half vector points to wo's side whichever is denser; eta (wi.h) = -(refracted cosine) * eta.
vec3 eval_refraction(Bsdf b, Interface surface, vec3 wo, vec3 wi, out float pdf) {
  pdf = 0.0;
  float eta = surface.eta;
  vec3 h = normalize(wo + eta * wi);
  if (h.z < 0.0) h = -h;
  float o = dot(wo, h), i = dot(wi, h);
  if (o <= 0.0 || i >= 0.0) return vec3(0.0); // back-facing microfacet
  vec3 transmittance = facet_transmittance(b, surface, o);
  float s = o + eta * i;
  float jacobian = 4.0 * o * -i / max(s * s, 1e-30); // Jacobian of h, relative to the mirror's 1 / (4 o) and to eta^2
  float reflected = reflect_probability(facet_reflectance(b, surface, o), transmittance);
  pdf = facet_reflected_pdf(b, wo, h) * (1.0 - reflected) * jacobian * eta * eta;
  return transmittance * (facet_distribution(b, h) * facet_visibility(b, wo, wi) * -wi.z * jacobian);
}

// f |cos(wi)| of all lobes that are not delta, and the density with which bsdf_sample_direction draws wi from them.
vec3 eval_lobes(Bsdf b, Lobes l, vec3 wo, vec3 wi, out float pdf) {
  vec3 value = vec3(0.0);
  pdf = 0.0;
  float lobe_pdf = 0.0;
  if (wi.z > 0.0) {
    value = eval_diffuse(b, l, wi, lobe_pdf);
    pdf = l.diffuse_probability * lobe_pdf;
    if (kThrough) pdf *= 1.0 - l.through;
    value *= layers_pass_diffuse(b, l, wi);
    vec3 facets = vec3(0.0);
    if (kMicrofacets && !l.delta_reflection) {
      facets = eval_reflection(b, l.surface, wo, wi, lobe_pdf);
      pdf += l.facet_probability * lobe_pdf;
      facets += eval_multiple(b, l, wi);
    }
    value += facets * layers_pass(b, l, wi);
    add_cover(b, l, wo, wi, value, pdf);
  } else if (wi.z < 0.0) {
    if (has(kFeatureTransmission) && b.transmission > 0.0 && !l.delta_transmission) {
      value = b.thin ? eval_thin_transmission(b, l.surface, wo, wi, lobe_pdf)
                     : eval_refraction(b, l.surface, wo, wi, lobe_pdf);
      pdf = l.facet_probability * lobe_pdf;
    }
    value += eval_through(b, l, wi, lobe_pdf);
    pdf += l.diffuse_probability * l.through * lobe_pdf;
    value *= layers_pass(b, l, wi);
  }
  return value;
}

// ---- sampling ---------------------------------------------------------------------------------------------------

// Refracts wo at a microfacet h; false at total reflection. The result is normalized, because 1/eta and the root near
// the critical angle magnify rounding.
bool refract_direction(vec3 wo, vec3 h, float eta, out vec3 wi) {
  float c = dot(wo, h);
  float g2 = c * c + (eta - 1.0) * (eta + 1.0);
  wi = normalize(h * (c - sqrt(max(g2, 0.0))) - wo);
  return g2 > 0.0;
}

// True if u falls into a fraction of the unit interval. In both cases u becomes the rest, again in [0, 1), so that
// points of a net that make the same choice still form a net.
bool take_with_probability(inout float u, float probability) {
  if (probability <= 0.0) return false;
  bool taken = u < probability;
  u = min(taken ? u / probability : (u - probability) / (1.0 - probability), kOneMinusEpsilon);
  return taken;
}

// A direction from the microfacet lobes; `u_side` decides whether it is reflected or transmitted. `delta`: the lobe is
// a delta lobe; only then does s.weight hold f |cos| / pdf.
bool sample_facets(Bsdf b, Lobes l, vec3 wo, float u_side, vec2 u, inout BsdfSample s, out bool delta) {
  vec3 h = l.delta_reflection ? vec3(0.0, 0.0, 1.0) : sample_facet(b, wo, u);
  float c = dot(wo, h);
  vec3 reflectance = facet_reflectance(b, l.surface, c);
  vec3 transmittance = facet_transmittance(b, l.surface, c);
  float q = reflect_probability(reflectance, transmittance);
  s.transmitted = u_side >= q;
  vec3 mirrored = 2.0 * c * h - wo;
  if (!s.transmitted) {
    s.wi = mirrored;
    delta = l.delta_reflection;
    s.weight = reflectance / (q * l.facet_probability);
    return s.wi.z > 0.0;
  }
  delta = l.delta_transmission;
  if (delta) h = vec3(0.0, 0.0, 1.0);
  s.weight = transmittance / ((1.0 - q) * l.facet_probability);
  if (b.thin) {
    s.wi = delta ? -wo : vec3(mirrored.xy, -mirrored.z);
    return s.wi.z < 0.0;
  }
  s.eta_scale = l.surface.eta * l.surface.eta;
  s.weight /= s.eta_scale;
  return refract_direction(wo, h, l.surface.eta, s.wi) && s.wi.z < 0.0;
}

// Draws wi from one of the lobes, which u.y picks (by u.x StanfordDragon has 1.05 times the squared error). False if
// the path ends here: there is no lobe, or wi is on the wrong side after a single bounce between microfacets. `u_side`
// picks reflection or transmission within the lobe. `delta`: the lobe is a delta lobe; only then are s.pdf and s.weight
// set.
bool bsdf_sample_direction(Bsdf b, Lobes l, vec3 wo, float u_side, vec2 u, out BsdfSample s, out bool delta) {
  s = BsdfSample(vec3(0.0, 0.0, 1.0), vec3(0.0), 0.0, 1.0, false, false);
  delta = false;
  if (l.diffuse_probability + l.facet_probability + l.coat_probability == 0.0) return false;
  if (take_with_probability(u.y, l.coat_probability)) {
    if (!draw_from_coat(b, l, wo, u, s, delta)) return false;
    if (delta) s.pdf = -1.0;
    return true;
  }
  if (!kMicrofacets || !take_with_probability(u.y, l.facet_probability / (1.0 - l.coat_probability))) {
    s.wi = kHemisphere == kHemisphereUniform ? warp_uniform_hemisphere(u) : warp_cosine_hemisphere(u);
    s.wide = true;
    if (kThrough && u_side < l.through) {
      s.wi.z = -s.wi.z;
      s.transmitted = true;
      if (!b.thin) s.eta_scale = l.surface.eta * l.surface.eta;
    }
    return true;
  }
  if (!sample_facets(b, l, wo, u_side, u, s, delta)) return false;
  if (delta) {
    s.pdf = -1.0;
    s.weight *= layers_pass(b, l, s.wi);
  }
  return true;
}

// True if any lobe is not a delta lobe; otherwise next-event estimation finds nothing.
bool bsdf_has_smooth(Bsdf b) {
  if (!kMicrofacets) return true;
  if (has_rough_cover(b)) return true;
  bool diffuse = b.metallic < 1.0 && b.transmission < 1.0 && max_component(b.base_color) > 0.0;
  bool facets = !is_mirror(b) && (b.metallic > 0.0 || b.specular > 0.0 || b.transmission > 0.0);
  return diffuse || facets;
}

#endif
