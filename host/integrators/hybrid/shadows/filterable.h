// What techniques have in common that average something over a map before it is looked up
// (kernels/hybrid/shadows/blur.glsl).
#pragma once

#include <array>
#include <string_view>

#include "host/integrators/hybrid/shadows/shadow_maps.h"

namespace wavepath {

// Stages of their programs.
enum FilterableStage : std::size_t { kFilterableLookUp, kBlurRows, kBlurColumns, kFilterableStageCount };
using FilterableStages = std::array<KernelCode, kFilterableStageCount>;

inline constexpr std::array<std::size_t, kFilterableStageCount> kFilterableOrder = {kFilterableLookUp, kBlurRows,
                                                                                    kBlurColumns};
inline constexpr std::array<MapPass, 2> kBlurPasses = {{{kBlurRows}, {kBlurColumns}}};

inline constexpr std::array<std::string_view, 4> kFilterableSettings = {"shadow-size", "shadow-bias", "shadow-source",
                                                                        "shadow-blur"};

// `exponent`: --shadow-exponent unless that is given.
constexpr ShadowMapRecipe filterable_recipe(double exponent = 0.0) {
  return {.guard = [](const RenderPlan& settings) { return settings.shadow_blur; },
          .filtered_bytes = [](const RenderPlan&) { return std::uint64_t{sizeof(gpu::vec4)}; },
          .scratch_bytes = [](const RenderPlan&) { return std::uint64_t{sizeof(gpu::vec4)}; },
          .passes = kBlurPasses,
          .exponent = exponent};
}

} // namespace wavepath
