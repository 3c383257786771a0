// Techniques of transparency: what is known of one before there is a device, and what one of layers consists of.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "host/gpu/raster.h"
#include "host/render/settings/render_plan.h"
#include "kernels/base/scene_types.h"

namespace wavepath {

inline bool is_blended(const gpu::Material& material) { return material.flags & gpu::kMaterialBlend; }

// Recipe that draws the triangles of layers in front of the opaque surfaces, BLEND ones unless it says otherwise, into
// a picture of the layers alone: their light, and the fraction of the light behind them that they let pass.
struct LayerRecipe {
  RasterCode code; // layer.vert, and a fragment shader
  std::span<const AttachmentInfo> attachments;
  RasterState state{};
  bool sorts = false; // from back to front
  // Makes the layers of what was drawn, pixel by pixel; empty = the first attachment holds them.
  KernelCode finish{};
  // Times that everything is drawn, each followed by `finish`.
  std::uint32_t (*passes)(const RenderPlan& settings) = [](const RenderPlan&) { return 1u; };
  std::span<const std::uint32_t> bindings{}; // for each attachment, the binding that it is copied to for `finish`
  bool (*holds)(const gpu::Material& material) = is_blended;
};

// One constant for each stands in its file.
struct TransparencyKind {
  std::string_view name; // value of --transparency
  std::string_view summary;
  std::string_view subject = "BLEND surfaces";         // surfaces that the summary is about
  std::span<const std::string_view> settings{};        // settings that it supports
  std::uint32_t flag = 0;                              // kHybrid bit of its frames
  const LayerRecipe* layers = nullptr;                 // null = it has none
  void (*check)(const RenderPlan& settings) = nullptr; // throws UsageError where settings do not go with it
};

} // namespace wavepath
