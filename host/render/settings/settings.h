// The settings of a render, as a user asks for them; render_plan.h adds what is decided. A new setting also needs a row
// in settings_table.cpp, from which its flag, identity, copied command, stats and widget follow.
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

// Rays that Whitted's ray tracer follows from a smooth interface: both reflection and refraction, or one at random.
inline constexpr std::uint32_t kBranchingTree = 0, kBranchingChoice = 1;

// Method that finds first hits of frames: the faster one for the device type; rasterization; ray tracing.
inline constexpr std::uint32_t kFirstHitAuto = 0, kFirstHitRaster = 1, kFirstHitTraced = 2;

// Method that traces rays. auto: ray queries if the device has hardware for them, else compute kernels. compute: our
// own traversal in compute kernels. hardware: ray queries always.
inline constexpr std::uint32_t kTraversalAuto = 0, kTraversalCompute = 1, kTraversalHardware = 2;

// Filter of textures: in kernels with fp32 arithmetic, or by the device's samplers.
inline constexpr std::uint32_t kTexturesExact = 0, kTexturesHardware = 1;

// Distribution of samples by noise: where it pays; never; always.
inline constexpr std::uint32_t kAdaptiveAuto = 0, kAdaptiveOff = 1, kAdaptiveOn = 2;

// Reuse of paths between neighbouring pixels: where it pays; always; never.
inline constexpr std::uint32_t kReuseAuto = 0, kReuseOn = 1, kReuseOff = 2;

// Noise filter: none; our own; Intel's Open Image Denoise, for finished pictures.
inline constexpr std::uint32_t kDenoiseOff = 0, kDenoiseOn = 1, kDenoiseOidn = 2;

struct IntegratorKind; // host/render/settings/integrator_kind.h
const IntegratorKind& default_integrator();

// A value of --integrator: one of the kinds, or auto. Until auto is decided, it renders as the default kind.
class IntegratorSetting {
public:
  IntegratorSetting(const IntegratorKind* kind) : kind_(kind) {} // never null
  static IntegratorSetting automatic() {
    IntegratorSetting setting(&default_integrator());
    setting.is_auto_ = true;
    return setting;
  }
  bool is_auto() const { return is_auto_; } // the plan may take another kind
  operator const IntegratorKind*() const { return kind_; }
  const IntegratorKind* operator->() const { return kind_; }

private:
  const IntegratorKind* kind_;
  bool is_auto_ = false;
};

// Limit of shadow rays, and of occlusion rays, for each sample of a pixel; more rays need more samples.
inline constexpr std::uint32_t kMostFrameRays = 256;

struct Lens {
  double aperture = 0.0; // diameter in metres; 0 = a pinhole
  // Metres along the view axis; empty = distance of the surface in the middle of the picture.
  std::optional<double> focus;
  std::uint32_t blades = 0; // corners of the aperture, a regular polygon; 0 = a disc
};

// A rectangle of pixels, counted from the left top corner of the whole picture.
struct Crop {
  std::uint32_t left = 0, top = 0, width = 0, height = 0;
  bool operator==(const Crop&) const = default;
};

struct RenderSettings {
  IntegratorSetting integrator = &default_integrator();
  std::uint32_t width = 1280, height = 720; // of the whole picture
  std::optional<Crop> crop;                 // the part of it that is rendered (crop.h); empty = all
  std::uint32_t first_sample = 0;           // range of samples of every pixel: first_sample <= s < last_sample
  std::uint32_t last_sample = 64;
  // Samples of the whole render that this range is a part of, for stratification; 0 = last_sample.
  std::uint32_t sample_total = 0;
  double time_limit = 0.0;   // rendering seconds; 0 = unlimited
  double target_error = 0.0; // estimated relative RMS error at which to stop; 0 = none
  std::uint32_t max_depth = 8;
  std::uint32_t sampler = gpu::kSamplerSobol;
  std::uint32_t hemisphere = gpu::kHemisphereCosine;
  std::uint32_t direct = gpu::kDirectMis;
  std::uint32_t filter = gpu::kFilterBlackmanHarris;
  std::uint32_t seed = 0;
  std::uint32_t cull = gpu::kCullCamera;    // which rays pass single-sided surfaces from behind
  std::uint32_t traversal = kTraversalAuto; // method that traces rays
  std::uint32_t textures = kTexturesExact;  // filter of textures; the scene must have been packed for it
  // Settings that some integrators do not support:
  std::uint32_t terminator = gpu::kTerminatorFacets; // start of rays at surfaces with vertex normals
  Lens lens;
  std::uint32_t first_hit = kFirstHitAuto;
  std::uint32_t shadow_samples = 1; // light samples for each sample of a pixel
  std::uint32_t ao_samples = 1;     // occlusion rays for each sample of a pixel
  // Metres; 0 = unlimited. Empty: a tenth of the scene's radius, but unlimited for ambient occlusion by rays.
  std::optional<double> ao_radius;
  std::uint32_t occlusion = 0; // index into kOcclusionTechniques
  std::uint32_t antialias = 0; // index into kAntialiasTechniques
  double ao_bias = 10.0;       // degrees above the tangent plane below which nothing occludes
  // 0 to 1: how much a visible background lowers the horizon of the body before it, as if that were thin.
  double ao_thinness = 0.0;
  std::uint32_t voxels = 256;               // along the longest side of the scene, for cones
  std::optional<glm::vec3> ambient;         // radiance; empty = estimated from the direct light in the picture
  std::uint32_t shadows = 0;                // index into kShadowTechniques
  std::uint32_t shadow_size = 1024;         // texels along a side of a light's shadow map
  std::uint32_t shadow_bias = 1;            // index into kShadowBiasNames
  std::optional<double> shadow_bias_amount; // in widths of a texel; empty = default of the kind of bias
  std::uint32_t shadow_taps = 16;           // texels that a filter looks up
  std::uint32_t shadow_pattern = 0;         // pattern of these texels: index into kShadowPatternNames
  double shadow_blur = 2.0;                 // radius of a filter, in texels
  std::uint32_t shadow_cascades = 4;        // views that divide the depth range in front of the camera
  std::optional<double> shadow_exponent;    // exponent of exponential maps; empty = default of the technique
  std::uint32_t shadow_bits = 32;           // bits of each moment in a moment map
  std::uint32_t shadow_source = 0;          // method that makes maps: index into kShadowSourceNames
  std::string shadow_cookie;                // path of a picture that the light is projected through; empty = none
  double shadow_ambient = 0.0;              // fraction of a light that reaches surfaces in its shadow
  std::uint32_t shading = 0;                // reflection model of first hits: index into kShadingModels
  std::uint32_t interpolation = 2;          // where the model is evaluated: index into kInterpolationNames
  std::optional<double> shininess;          // exponent of highlights; empty = from the material's roughness
  std::optional<glm::vec3> attenuation;     // 1 / (x + y d + z d^2) at distance d of a light; empty = 1 / d^2
  std::optional<glm::vec2> depth_cue;       // depths between which surfaces fade into the background; empty = none
  std::uint32_t transparency = 0;           // technique for BLEND surfaces: index into kTransparencyTechniques
  std::uint32_t transparency_layers = 4;    // layers that are peeled off
  std::uint32_t transparency_samples = 8;   // samples of stochastic transparency for each sample of a pixel
  std::uint32_t reflections = 0;            // what mirrors show of lit surfaces: index into kReflectionTechniques
  double reflection_threshold = 0.1;        // least reflectance, head-on, of surfaces that are mirrors
  std::uint32_t bounce = 0;                 // light of one diffuse bounce: index into kBounceTechniques
  std::uint32_t branching = kBranchingTree;
  std::uint32_t techniques = gpu::kTechniquesAll; // kTechnique bits
  double cutoff = 1.0 / 256.0;                    // weight below which rays are not followed; biased unless it is 0
  std::uint32_t patches = 4096;                   // patches of the radiosity mesh
  std::uint32_t subdivision = 0;                  // how surfaces are cut into patches: index into kSubdivisionNames
  std::uint32_t form_factors = 0;      // how the light between patches is measured: index into kFormFactorNames
  std::uint32_t patch_rays = 64;       // rays for each patch that the light of all lamps is sent by
  bool gather = false;                 // every sample gathers the light of patches by rays of its own
  std::uint32_t denoise = kDenoiseOff; // noise filter of every frame or of the finished picture (denoising.h); biased
  bool mips = true;                    // mip levels in frames of one sample (mips.h); biased
  std::uint32_t lights = gpu::kLightsAuto; // how next-event estimation chooses a light: kLights constants
  // Light samples where a path first scatters; 0 = auto, by the scene (direct_sampling.h).
  std::uint32_t light_samples = 0;
  std::uint32_t sky_samples = 0;    // sky directions of a vertex; 0 = auto: by pilots, 1 without (direct_sampling.h)
  std::uint32_t reuse = kReuseAuto; // reuse of paths between neighbouring pixels (path_reuse.h)
  std::uint32_t adaptive = kAdaptiveAuto; // more samples where a pilot found more noise (adaptive.h)
  double clamp = 0.0; // largest radiance of a sample, in its brightest channel; biased; 0 = no limit
  bool guide = false; // path guiding: directions are also drawn from a trained field
  bool specialize = true;
  std::vector<std::string> aovs;         // values of --aov
  bool aov_through = false;              // albedo and normal are those of what mirrors and smooth glass show
  std::vector<std::string> light_groups; // names of --light-groups, or `each`; empty = none
  bool transparent = false;              // alpha tells where rays leave the scene
};

} // namespace wavepath
