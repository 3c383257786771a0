// Types of the surface model: a material at a point, and a sample of its BSDF.
//
// Kernels come in two builds: with LAYERED for scenes whose materials have layers (kLobesLayered), and without, in
// which not even the code of these is there. A driver pays for code when it compiles, whether or not a specialization
// constant then removes it: the kernels of DamagedHelmet would take 2.2 s instead of 1.4 (llvmpipe, two cores).
#ifndef WAVEPATH_BSDF_TYPES_GLSL
#define WAVEPATH_BSDF_TYPES_GLSL

#include "kernels/base/config.glsl"
#include "kernels/surface/fresnel.glsl"
#include "kernels/base/math.glsl"
#include "kernels/base/scene_types.h"
#ifdef LAYERED
#include "kernels/surface/coat.glsl"
#include "kernels/surface/sheen.glsl"
#include "kernels/surface/thin_film.glsl"
#endif

struct Bsdf {
  vec3 base_color; // [0, 1]
  float metallic;
  vec3 specular_color;
  float specular;
  float alpha; // roughness^2
  float transmission;
  float ior;     // of the body relative to vacuum; 0 = infinite
  bool entering; // wo is outside of the body; ignored where thin
  bool thin;     // no volume behind the surface: light passes unbent
  uint ggx_table, glass_table; // albedo tables (kLobeMultiple); kNone: the scene has none

#ifdef LAYERED // each in kernels that have its lobe alone
  Coat coat;
  Sheen sheen;
  Film film;
  vec2 stretched_alpha;        // along the tangent and the bitangent; both alpha where there is no anisotropy
  vec3 diffuse_through;        // albedo of the diffuse base towards the other side
  float diffuse_transmission;  // fraction of the diffuse base that scatters there
  bool disperses;              // `ior` is that of one channel
#endif
};

struct BsdfSample {
  vec3 wi;
  vec3 weight;     // f |cos| / pdf
  float pdf;       // per solid angle, of all lobes together; negative: a delta lobe
  float eta_scale; // squared relative ior crossed, 1 if none
  bool transmitted;
  bool wide; // drawn from the lobe of the diffuse base
};

// Closer to 1 than this, rough refraction bends by less than 1e-3 alpha and its half vector is lost in rounding: it
// passes as delta.
const float kMinEtaStep = 1e-3;

// Values that eval and sample both need: the material as seen from wo.
struct Lobes {
  Interface surface;
  vec3 diffuse; // albedo of the base with the coupling of wo and the mean; that of wi is still missing
  float base_coupling; // the same of a white base
  float diffuse_probability; // all lobes together: either 0, or summing to 1
  float facet_probability;
  float coat_probability;
  float through; // fraction of the diffuse draws, which serve all wide lobes, that go to the other side
  bool delta_reflection;
  bool delta_transmission;
  vec3 multiple, multiple_through; // (1 - albedo along wo) / (pi * mean), coloured, to either side (kLobeMultiple)

#ifdef LAYERED // each in kernels that have its lobe alone
  float sheen_passed; // along wo
  float coat_passed;  // along wo, and on average
  float coat_passed_mean;
#endif
};

// Luminance of the fractions of light that lobes scatter, from which the chances to draw them follow.
struct LobeWeights {
  float coat, facets, reflected, through; // the last two of wide lobes, to either side
};

// The interface of a material as seen from its side; only materials that transmit light have an inside.
Interface surface_of(Bsdf b) {
  return make_interface(b.ior, b.specular_color, b.specular, b.thin || b.entering || b.transmission == 0.0);
}

// The layers are on the outside; a thin wall has two of them.
bool is_outside(Bsdf b, float side) { return b.thin || (side > 0.0) == b.entering; }

#endif
