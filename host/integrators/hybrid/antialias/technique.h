// Description of an anti-aliasing technique, which needs no device.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include <glm/glm.hpp>

#include "host/gpu/kernel.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

// Each technique defines one constant of this type in its own file.
struct AntialiasKind {
  std::string_view name; // value of --antialias
  std::string_view summary;
  // Where frame `sample` of `total` sees every pixel, from its centre; null: at a random position of the pixel filter.
  glm::vec2 (*position)(std::uint32_t sample, std::uint32_t total) = nullptr;
  std::span<const KernelCode> passes{}; // over every frame; the last one writes it
  // Number of consecutive frames that belong together: they share shading, see kHybridMultisample, or see the parts of
  // pixels, see kHybridFractions. 0 = none do.
  std::uint32_t positions = 0;
  std::optional<std::uint32_t> beam{}; // kBeam constant: beams of this shape find the parts of pixels
  bool over_time = false;              // joins frames to those before, by the only pass, or as Taa does without one
  bool halves = false;                 // frames have half the size, and the pass joins them at the picture's
  bool is_biased = true;
  void (*check)(const RenderPlan& settings) = nullptr; // throws UsageError where settings do not go with it

  // The pass that joins frames; empty = there is none, or it is that of Taa.
  std::span<const KernelCode> joining() const { return over_time ? passes : std::span<const KernelCode>{}; }
};

// Samples that the whole render is to have of every pixel.
inline std::uint32_t whole_samples(const RenderPlan& settings) {
  return settings.sample_total > 0 ? settings.sample_total : settings.last_sample;
}

inline glm::vec2 pixel_centre(std::uint32_t, std::uint32_t) { return glm::vec2(0.0f); }

} // namespace wavepath
