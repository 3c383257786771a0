// The settings of a render with everything decided for it: training, kernel capacity, and its role beside another
// picture. host/plan makes the decisions; host/render and host/integrators only read them.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "host/render/settings/settings.h"

namespace wavepath {

// Iterations of guide training in short renders and in parts of a render.
inline constexpr std::uint32_t kGuideIterations = 4;

// Scenes for which kernels support reuse of paths: none; those without a light tree or environment map to train on;
// all.
enum class BearsReuse { nowhere, untrained, anywhere };

// Trained probabilities: of lights, as light_histograms.h makes them for kernels/light/light_selection.glsl; of parts
// of the sky, as sky_histograms.h makes them for kernels/light/learned_sky.glsl. Null = not trained.
struct LightProbabilities {
  std::shared_ptr<const std::vector<std::uint32_t>> lights, sky;
  explicit operator bool() const { return lights || sky; }
  bool operator==(const LightProbabilities&) const = default;
};

// Training before the first sample.
struct Training {
  // Paths of light training; 0 = a fixed number, the same in every part of a render (light_trainer.cpp).
  std::uint64_t paths = 0;
  std::uint32_t guide_iterations = kGuideIterations; // of guide training, at most
  bool one_colour = true;     // also train directions to a sky of one colour, if shadow rays look for it
  LightProbabilities found{}; // result of another render's training, used in place of training
};

// Features that kernels must support though this render does not use them, since other renders use the same kernels.
// They do not change the picture.
struct KernelCapacity {
  bool shared_sky = false; // shadow rays to a sky of one colour, any number of them, in scenes where pilots are cheap
  BearsReuse reuse = BearsReuse::nowhere;
  bool shadow_rays = false; // shadow rays, even if no light is sampled
  bool has_probes = false;  // error probes, even if the picture is too small for them
  bool mips = false;        // mip levels in kernels and scene, even if this picture looks textures up exactly
  gpu::Feature added = 0, removed = 0; // kFeature bits to compile in beyond the scene's, and to leave out
};

struct RenderPlan : RenderSettings {
  RenderPlan() = default;
  RenderPlan(const RenderSettings& settings) : RenderSettings(settings) {} // no decision made

  // Names of the groups that light_groups makes in this scene (host/scene/pack/light_groups.h).
  std::vector<std::string> group_names;
  Training training;
  KernelCapacity kernels;
  bool looks_for_noise = false;         // `adaptive` is `auto`: a pilot measures noise when the render begins
  bool moving = false;                  // the scene was loaded with motion, which kernels must support
  bool catches = false;                 // the scene has a shadow catcher (--catcher)
  bool antialias_over_time = false;     // blends each picture with earlier ones, for a moving camera; biased
  std::uint32_t probes_from = 1u << 15; // least number of pixels for error probes (probing.h)
  // Scale of the four pixels of a quad, below 1 in pilots that show few quads of a larger picture (path_reuse.h).
  double quad_scale = 1.0;
  std::uint32_t wave_slots = 0; // paths in flight; 0 = chosen from memory and measured dispatch time
};

} // namespace wavepath
