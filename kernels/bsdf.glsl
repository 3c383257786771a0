// The surface model of glTF 2.0: metallic-roughness with KHR_materials_specular, _ior, _transmission and _volume.
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

#include "kernels/config.glsl"
#include "kernels/fresnel.glsl"
#include "kernels/math.glsl"
#include "kernels/microfacet.glsl"
#include "kernels/scene_types.h"

struct Bsdf {
  vec3 base_color; // [0, 1]
  float metallic;
  vec3 specular_color;
  float specular;
  float alpha; // roughness^2
  float transmission;
  float ior;     // of the body against vacuum; 0 = infinite
  bool entering; // wo is outside of the body; ignored where thin
  bool thin;     // no volume behind the surface: light passes unbent
};

struct BsdfSample {
  vec3 wi;
  vec3 weight;     // f |cos| / pdf
  float pdf;       // per solid angle, of all lobes together; negative: a delta lobe
  float eta_scale; // squared relative ior crossed, 1 if none
  bool transmitted;
};

// Closer to 1 than this, rough refraction bends by less than 1e-3 alpha and its half vector is lost in rounding: it
// passes as delta.
const float kMinEtaStep = 1e-3;

// What eval and sample share: the material as seen from wo.
struct Lobes {
  Interface surface;
  vec3 diffuse; // albedo of the base with the coupling of wo and the mean; that of wi is still missing
  float diffuse_probability;
  float facet_probability; // of both together, either 0 + 0 or summing to 1
  bool delta_reflection;
  bool delta_transmission;
};

const bool kMicrofacets = (kFeatures & (kFeatureSpecular | kFeatureTransmission)) != 0u;

// Only materials that transmit light have an inside.
Interface surface_of(Bsdf b) {
  return make_interface(b.ior, b.specular_color, b.specular, b.thin || b.entering || b.transmission == 0.0);
}

// Fraction reflected at a microfacet that wo meets with cosine c.
vec3 facet_reflectance(Bsdf b, Interface surface, float c) {
  return fresnel_dielectric(surface, c) * (1.0 - b.metallic) + fresnel_conductor(b.base_color, c) * b.metallic;
}

// Fraction transmitted there, before the 1/eta^2 of radiance.
vec3 facet_transmittance(Bsdf b, Interface surface, float c) {
  if (!has(kFeatureTransmission)) return vec3(0.0);
  float passed = (1.0 - b.metallic) * b.transmission * (1.0 - max_component(fresnel_dielectric(surface, c)));
  return passed * b.base_color;
}

// A thin smooth pane: light that it transmits goes straight on, so that shadow rays may pass.
bool is_pane(Bsdf b) { return has(kFeatureTransmission) && b.thin && b.alpha < kMinAlpha && b.transmission > 0.0; }

// What passes it at this cosine: the throughput of the delta lobe that sample_facets() draws, over all its draws.
vec3 pane_transmittance(Bsdf b, float c) { return facet_transmittance(b, surface_of(b), c); }

// Probability of reflecting rather than transmitting at the microfacet.
float reflect_probability(vec3 reflectance, vec3 transmittance) {
  float r = luminance(reflectance), t = luminance(transmittance);
  return t > 0.0 ? r / (r + t) : 1.0;
}

bool is_lambert(Bsdf b) {
  return !kMicrofacets || (b.metallic == 0.0 && b.transmission == 0.0 && (b.specular == 0.0 || b.ior == 1.0));
}

Lobes lobes_of(Bsdf b, vec3 wo) {
  Lobes l;
  l.diffuse = b.base_color;
  l.diffuse_probability = luminance(b.base_color) > 0.0 ? 1.0 : 0.0;
  l.facet_probability = 0.0;
  l.delta_reflection = l.delta_transmission = false;
  if (!kMicrofacets) return l;

  l.surface = surface_of(b);
  l.delta_reflection = b.alpha < kMinAlpha;
  l.delta_transmission = l.delta_reflection || (!b.thin && abs(l.surface.eta - 1.0) < kMinEtaStep);
  float below = interface_transmittance(l.surface, wo.z, b.alpha);
  float base = (1.0 - b.metallic) * (1.0 - b.transmission);
  float mean = l.surface.eta < 1.0 ? 0.0 : interface_mean(l.surface, b.alpha);
  l.diffuse = b.base_color * (base * below / max(1.0 - mean, 1e-6));
  float facets = luminance(facet_reflectance(b, l.surface, wo.z)) + luminance(facet_transmittance(b, l.surface, wo.z));
  float diffuse = luminance(b.base_color) * base * below;
  if (diffuse + facets > 0.0) {
    l.facet_probability = diffuse > 0.0 ? facets / (diffuse + facets) : 1.0;
    l.diffuse_probability = 1.0 - l.facet_probability;
  } else {
    l.diffuse_probability = 0.0;
  }
  return l;
}

// ---- evaluation -------------------------------------------------------------------------------------------------

vec3 eval_diffuse(Bsdf b, Lobes l, vec3 wi, out float pdf) {
  pdf = kHemisphere == kHemisphereUniform ? warp_uniform_hemisphere_pdf() : warp_cosine_hemisphere_pdf(wi.z);
  vec3 value = l.diffuse * (kInvPi * wi.z);
  return kMicrofacets ? value * interface_transmittance(l.surface, wi.z, b.alpha) : value;
}

vec3 eval_reflection(Bsdf b, Interface surface, vec3 wo, vec3 wi, out float pdf) {
  vec3 h = normalize(wo + wi);
  float c = dot(wo, h);
  vec3 reflectance = facet_reflectance(b, surface, c);
  pdf = ggx_reflected_pdf(wo, h, b.alpha) * reflect_probability(reflectance, facet_transmittance(b, surface, c));
  return reflectance * (ggx_distribution(h, b.alpha) * smith_visibility(wo, wi, b.alpha) * wi.z);
}

// Thin walls scatter as reflection does, then mirrored to the other side (KHR_materials_transmission).
vec3 eval_thin_transmission(Bsdf b, Interface surface, vec3 wo, vec3 wi, out float pdf) {
  vec3 mirrored = vec3(wi.xy, -wi.z);
  vec3 h = normalize(wo + mirrored);
  float c = dot(wo, h);
  vec3 transmittance = facet_transmittance(b, surface, c);
  float reflected = reflect_probability(facet_reflectance(b, surface, c), transmittance);
  pdf = ggx_reflected_pdf(wo, h, b.alpha) * (1.0 - reflected);
  return transmittance * (ggx_distribution(h, b.alpha) * smith_visibility(wo, wi, b.alpha) * mirrored.z);
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
  float jacobian = 4.0 * o * -i / max(s * s, 1e-30); // of h, over the mirror's 1 / (4 o) and over eta^2
  float reflected = reflect_probability(facet_reflectance(b, surface, o), transmittance);
  pdf = ggx_reflected_pdf(wo, h, b.alpha) * (1.0 - reflected) * jacobian * eta * eta;
  return transmittance * (ggx_distribution(h, b.alpha) * smith_visibility(wo, wi, b.alpha) * -wi.z * jacobian);
}

// f |cos(wi)| of all lobes that are not delta, and the density with which bsdf_sample draws wi from them.
vec3 eval_lobes(Bsdf b, Lobes l, vec3 wo, vec3 wi, out float pdf) {
  vec3 value = vec3(0.0);
  pdf = 0.0;
  float lobe_pdf = 0.0;
  if (wi.z > 0.0) {
    value = eval_diffuse(b, l, wi, lobe_pdf);
    pdf = l.diffuse_probability * lobe_pdf;
    if (kMicrofacets && !l.delta_reflection) {
      value += eval_reflection(b, l.surface, wo, wi, lobe_pdf);
      pdf += l.facet_probability * lobe_pdf;
    }
  } else if (has(kFeatureTransmission) && wi.z < 0.0 && b.transmission > 0.0 && !l.delta_transmission) {
    value = b.thin ? eval_thin_transmission(b, l.surface, wo, wi, lobe_pdf)
                   : eval_refraction(b, l.surface, wo, wi, lobe_pdf);
    pdf = l.facet_probability * lobe_pdf;
  }
  return value;
}

vec3 bsdf_eval(Bsdf b, vec3 wo, vec3 wi, out float pdf) {
  pdf = 0.0;
  if (!(wo.z > 0.0)) return vec3(0.0);
  return eval_lobes(b, lobes_of(b, wo), wo, wi, pdf);
}

// ---- sampling ---------------------------------------------------------------------------------------------------

// wo bent at a microfacet h; false where it is totally reflected. Normalized, because 1/eta and the root near the
// critical angle magnify rounding.
bool refract_direction(vec3 wo, vec3 h, float eta, out vec3 wi) {
  float c = dot(wo, h);
  float g2 = c * c + (eta - 1.0) * (eta + 1.0);
  wi = normalize(h * (c - sqrt(max(g2, 0.0))) - wo);
  return g2 > 0.0;
}

// A direction from the microfacet lobes. `delta`: the lobe is a delta lobe; only then does s.weight hold f |cos| /
// pdf.
bool sample_facets(Bsdf b, Lobes l, vec3 wo, float u_lobe, vec2 u, inout BsdfSample s, out bool delta) {
  vec3 h = l.delta_reflection ? vec3(0.0, 0.0, 1.0) : ggx_sample_visible_normal(wo, b.alpha, u);
  float c = dot(wo, h);
  vec3 reflectance = facet_reflectance(b, l.surface, c);
  vec3 transmittance = facet_transmittance(b, l.surface, c);
  float q = reflect_probability(reflectance, transmittance);
  s.transmitted = u_lobe >= q;
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

// Draws wi from the lobes of which there are any; false if the path ends here (absorbed, or scattered into the wrong
// side by a single bounce between microfacets). `delta`: the lobe is a delta lobe; only then are s.pdf and s.weight set.
bool bsdf_sample_direction(Bsdf b, Lobes l, vec3 wo, float u_lobe, vec2 u, out BsdfSample s, out bool delta) {
  s = BsdfSample(vec3(0.0, 0.0, 1.0), vec3(0.0), 0.0, 1.0, false);
  delta = false;
  if (l.diffuse_probability + l.facet_probability == 0.0) return false;
  if (!kMicrofacets || u_lobe >= l.facet_probability) {
    s.wi = kHemisphere == kHemisphereUniform ? warp_uniform_hemisphere(u) : warp_cosine_hemisphere(u);
    return true;
  }
  if (!sample_facets(b, l, wo, min(u_lobe / l.facet_probability, kOneMinusEpsilon), u, s, delta)) return false;
  if (delta) s.pdf = -1.0;
  return true;
}

// Draws wi; false if the path ends here.
bool bsdf_sample(Bsdf b, vec3 wo, float u_lobe, vec2 u, out BsdfSample s) {
  s = BsdfSample(vec3(0.0, 0.0, 1.0), vec3(0.0), 0.0, 1.0, false);
  if (!(wo.z > 0.0)) return false;
  Lobes l = lobes_of(b, wo);
  bool delta;
  if (!bsdf_sample_direction(b, l, wo, u_lobe, u, s, delta)) return false;
  if (delta) return true;
  vec3 value = eval_lobes(b, l, wo, s.wi, s.pdf);
  if (!(s.pdf > 0.0) || !is_finite(s.pdf)) return false;
  bool cancels = is_lambert(b) && kHemisphere == kHemisphereCosine; // f cos / pdf, with no need to round
  s.weight = cancels ? b.base_color : value / s.pdf;
  return true;
}

// Whether any lobe is not delta; otherwise next-event estimation finds nothing.
bool bsdf_has_smooth(Bsdf b) {
  if (!kMicrofacets) return true;
  bool diffuse = b.metallic < 1.0 && b.transmission < 1.0 && max_component(b.base_color) > 0.0;
  bool facets = b.alpha >= kMinAlpha && (b.metallic > 0.0 || b.specular > 0.0 || b.transmission > 0.0);
  return diffuse || facets;
}

#endif
