// What a picture is asked to be: everything that the user can set about a render.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "kernels/features.h"

namespace wavepath {

struct IntegratorKind; // host/render/integrator.h
const IntegratorKind& default_integrator();

// Light samples, or occlusion rays, of a pixel and frame at most; more come by more frames.
inline constexpr std::uint32_t kMostFrameRays = 256;

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
  // Of the hybrid integrators alone. A frame is one sample of the film.
  std::uint32_t shadow_samples = 1;    // light samples a pixel and frame
  std::uint32_t ao_samples = 1;        // occlusion rays a pixel and frame
  std::optional<double> ao_radius;     // metres, 0 = unlimited; empty: unlimited for ao, a tenth of the scene's radius for hybrid
  std::optional<glm::vec3> ambient;    // radiance; empty = estimated from the direct light in the picture
  bool denoise = false;                // filter shadows and occlusion over space and time; biased
  bool antialias_over_time = false;    // joins every frame to those before it, for a camera in motion; biased
  bool adaptive = false; // more samples where a pilot, which is thrown away, found more noise
  bool specialize = true;
  std::vector<std::string> aovs; // names of the contract's --aov

  // For measurements. kFeature bits compiled in though the scene leaves them out, and left out though it needs them.
  std::uint32_t added_features = 0, removed_features = 0;
  bool room_for_shadow_rays = false; // even where no light is sampled
  std::uint32_t wave_slots = 0;      // paths in flight; 0 = chosen from memory and measured dispatch time
};

} // namespace wavepath
