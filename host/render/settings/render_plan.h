// The settings of a render with what is decided about it besides: how its training is done, what its kernels must bear,
// and what picture beside another one it is. host/plan decides these; everything below reads them.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "host/render/settings/settings.h"

namespace wavepath {

// Training passes of --guide, of short renders and of parts.
inline constexpr std::uint32_t kGuideIterations = 4;

// Scenes for which kernels bear reuse of paths: none; those without lights or skies to train on; all.
enum class BearsReuse { nowhere, untrained, anywhere };

// What training has found of which lights reach where, as light_histograms.h makes it for
// kernels/light/light_selection.glsl, and of which parts of the sky, as sky_histograms.h does for
// kernels/light/learned_sky.glsl; null: nothing.
struct LightProbabilities {
  std::shared_ptr<const std::vector<std::uint32_t>> lights, sky;
  explicit operator bool() const { return lights || sky; }
  bool operator==(const LightProbabilities&) const = default;
};

// What the render learns before its first sample.
struct Training {
  std::uint64_t paths = 0;                           // for the choice of lights; 0 = as parts have (light_trainer.cpp)
  std::uint32_t guide_iterations = kGuideIterations; // for --guide, at most
  bool one_colour = true;                            // a sky of one colour is trained, where sky_samples > 1
  LightProbabilities found{};                        // by another picture of the scene, in place of training
};

// What kernels must bear beyond what these settings use: others by the same kernels do. The picture is the same.
struct KernelCapacity {
  bool sky_samples = false; // any number of them, where trying costs little
  BearsReuse reuse = BearsReuse::nowhere;
  bool shadow_rays = false;            // even where no light is sampled
  bool has_probes = false;             // even where the picture is too small
  bool mips = false;                   // also in the scene, even where this picture looks textures up exactly
  gpu::Feature added = 0, removed = 0; // kFeature bits compiled in though the scene leaves them out, and left out
};

struct RenderPlan : RenderSettings {
  RenderPlan() = default;
  RenderPlan(const RenderSettings& settings) : RenderSettings(settings) {} // as it is told, without any pilot

  Training training;
  KernelCapacity kernels;
  bool looks_for_noise = false;         // where `adaptive` is auto: a pilot decides when the render begins
  bool moving = false;                  // the scene was loaded with motion, which the kernels are to see
  bool antialias_over_time = false;     // joins every picture to those before it, for a camera in motion; biased
  std::uint32_t probes_from = 1u << 15; // pixels of a picture whose nets may stay whole (probing.h)
  double quad_scale = 1.0; // of the quads of a pilot, which then shows few quads of a larger picture (path_reuse.h)
  std::uint32_t wave_slots = 0; // paths in flight; 0 = chosen from memory and measured dispatch time
};

} // namespace wavepath
