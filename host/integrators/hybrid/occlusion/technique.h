// What is known of a technique of ambient occlusion in screen space before there is a device.
#pragma once

#include <span>
#include <string_view>

#include "host/render/workspace/kernel_set.h"

namespace wavepath {

// One constant for each stands in its file.
struct OcclusionKind {
  std::string_view name; // value of --occlusion
  std::string_view summary;
  std::span<const std::string_view> settings{};        // that it takes besides ao-samples and ao-radius
  const KernelProgram* program = nullptr;              // of one stage, with screen_space_layout()
  void (*check)(const RenderPlan& settings) = nullptr; // throws UsageError where settings do not go with it
};

} // namespace wavepath
