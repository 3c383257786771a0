// The settings of a render: what a user asks for. What is decided besides is in render_plan.h. A new one also gets a
// row in settings_table.cpp, from which its flag, identity, copied command, stats and widget follow;
// tests/settings_test.cpp fails without that row.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "kernels/base/features.h"
#include "kernels/bidirectional/bidirectional_types.h"

namespace wavepath {

// Which rays of a smooth interface Whitted's ray tracer follows: reflection and refraction, or one of them at random.
inline constexpr std::uint32_t kBranchingTree = 0, kBranchingChoice = 1;

// How frames find what pixels see: as this type of device does faster, rasterized, or traced.
inline constexpr std::uint32_t kFirstHitAuto = 0, kFirstHitRaster = 1, kFirstHitTraced = 2;

// By what rays are traced: by the device's ray queries where it has hardware for them, by our own traversal in compute
// kernels, or by ray queries in any case.
inline constexpr std::uint32_t kTraversalAuto = 0, kTraversalCompute = 1, kTraversalHardware = 2;

// By what textures are filtered: by kernels in fp32, or by the device's samplers.
inline constexpr std::uint32_t kTexturesExact = 0, kTexturesHardware = 1;

// Whether samples are distributed by noise: where that pays, never, or always.
inline constexpr std::uint32_t kAdaptiveAuto = 0, kAdaptiveOff = 1, kAdaptiveOn = 2;

// Whether pixels share the paths of their neighbours: where that pays, never, or always.
inline constexpr std::uint32_t kReuseAuto = 0, kReuseOn = 1, kReuseOff = 2;

// How noise is filtered: by filters of our own, or finished pictures by Intel's Open Image Denoise.
inline constexpr std::uint32_t kDenoiseOff = 0, kDenoiseOn = 1, kDenoiseOidn = 2;

struct IntegratorKind; // host/render/settings/integrator_kind.h
const IntegratorKind& default_integrator();

inline constexpr std::uint32_t kMostFrameRays = 256; // of a kind, for a sample of a pixel; more come by more samples

struct Lens {
  double aperture = 0.0;       // diameter in metres; 0 = a pinhole
  std::optional<double> focus; // metres along the view axis; empty = to what the middle of the picture shows
  std::uint32_t blades = 0;    // corners of the aperture, a regular polygon; 0 = a disc
};

struct RenderSettings {
  const IntegratorKind* integrator = &default_integrator(); // how light is found; never null
  std::uint32_t width = 1280, height = 720;
  std::uint32_t first_sample = 0; // render samples first_sample <= s < last_sample of every pixel
  std::uint32_t last_sample = 64;
  std::uint32_t sample_total = 0; // of the render that this range is a part of, for stratification; 0 = last_sample
  double time_limit = 0.0;        // rendering seconds; 0 = none
  double target_error = 0.0;      // estimated relative RMS error at which to stop; 0 = none
  std::uint32_t max_depth = 8;
  std::uint32_t sampler = gpu::kSamplerSobol;
  std::uint32_t hemisphere = gpu::kHemisphereCosine;
  std::uint32_t direct = gpu::kDirectMis;
  std::uint32_t filter = gpu::kFilterBlackmanHarris;
  std::uint32_t seed = 0;
  std::uint32_t cull = gpu::kCullCamera;    // rays that single-sided surfaces let pass from behind
  std::uint32_t traversal = kTraversalAuto; // by what rays are traced
  std::uint32_t textures = kTexturesExact;  // by what textures are filtered; the scene was packed for it
  // Taken by some integrators only.
  std::uint32_t terminator = gpu::kTerminatorFacets; // where rays leave surfaces with vertex normals
  Lens lens;
  std::uint32_t first_hit = kFirstHitAuto;
  std::uint32_t shadow_samples = 1; // light samples for every sample of a pixel
  std::uint32_t ao_samples = 1;     // occlusion rays for every sample of a pixel
  // Metres, 0 = unlimited; empty: a tenth of the scene's radius, but unlimited for ao by rays.
  std::optional<double> ao_radius;
  std::uint32_t occlusion = 0;              // technique: of kOcclusionTechniques
  std::uint32_t antialias = 0;              // technique: of kAntialiasTechniques
  double ao_bias = 10.0;                    // degrees over the tangent plane up to which nothing occludes
  double ao_thinness = 0.0;                 // fraction by which what is seen behind a body lowers its horizon
  std::optional<glm::vec3> ambient;         // radiance; empty = estimated from the direct light in the picture
  std::uint32_t shadows = 0;                // technique: of kShadowTechniques
  std::uint32_t shadow_size = 1024;         // texels along a side of what a light sees
  std::uint32_t shadow_bias = 1;            // of kShadowBiasNames
  std::optional<double> shadow_bias_amount; // in texels' width; empty = the kind's own
  std::uint32_t shadow_taps = 16;           // positions that a filter looks at
  std::uint32_t shadow_pattern = 0;         // of these positions: of kShadowPatternNames
  double shadow_blur = 2.0;                 // radius of a filter, in texels
  std::uint32_t shadow_cascades = 4;        // views that share the depths in front of the camera
  std::optional<double> shadow_exponent;    // of exponential maps; empty = the technique's own
  std::uint32_t shadow_bits = 32;           // of each moment that a map holds
  std::uint32_t shadow_source = 0;          // how maps are made: of kShadowSourceNames
  std::string shadow_cookie;                // file of a picture that lights are shone through; empty = none
  double shadow_ambient = 0.0;              // fraction of a light that reaches what is in its shadow
  std::uint32_t shading = 0;                // how first hits reflect: of kShadingModels
  std::uint32_t interpolation = 2;          // where that is evaluated: of kInterpolationNames
  std::optional<double> shininess;          // exponent of highlights; empty = from the material's roughness
  std::optional<glm::vec3> attenuation;     // 1 / (x + y d + z d^2) at distance d of a light; empty = 1 / d^2
  std::optional<glm::vec2> depth_cue;       // depths between which surfaces fade into the background; empty = none
  std::uint32_t transparency = 0;           // of BLEND surfaces: of kTransparencyTechniques
  std::uint32_t transparency_layers = 4;    // that are peeled off
  std::uint32_t transparency_samples = 8;   // of stochastic transparency, for every sample of a pixel
  std::uint32_t branching = kBranchingTree;
  std::uint32_t techniques = gpu::kTechniquesAll; // kTechnique bits
  double cutoff = 1.0 / 256.0;                    // weight below which rays are not followed; biased unless it is 0
  std::uint32_t denoise = kDenoiseOff;            // filter every frame, or the finished picture (denoising.h); biased
  bool mips = true;                               // textures at mip levels in frames of one sample (mips.h); biased
  std::uint32_t lights = gpu::kLightsAuto;        // how next-event estimation chooses among them
  std::uint32_t light_samples = 0;                // where a path first scatters; 0 = by the scene (light_samples.h)
  std::uint32_t sky_samples = 0;                  // a vertex; 0 = as pilots find, else 1 (light_samples.h)
  std::uint32_t reuse = kReuseAuto;               // of the paths of neighbouring pixels (path_reuse.h)
  std::uint32_t adaptive = kAdaptiveAuto;         // more samples where a pilot found more noise
  bool guide = false;                             // directions are also drawn from a trained field
  bool specialize = true;
  std::vector<std::string> aovs; // values of --aov
};

} // namespace wavepath
