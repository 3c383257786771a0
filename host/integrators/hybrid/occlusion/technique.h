// Description of a technique of ambient occlusion without rays, which needs no device.
#pragma once

#include <span>
#include <string_view>

#include "host/render/workspace/kernel_set.h"

namespace wavepath {

// Each technique defines one constant of this type in its own file.
struct OcclusionKind {
  std::string_view name; // value of --occlusion
  std::string_view summary;
  std::span<const std::string_view> settings{}; // settings that it supports besides ao-samples and ao-radius
  // A program of one stage, with screen_space_layout(), and the bindings of voxels if it needs them.
  const KernelProgram* program = nullptr;
  bool voxels = false;                                 // it looks at surface voxels, not at what the picture shows
  void (*check)(const RenderPlan& settings) = nullptr; // throws UsageError where settings do not go with it
};

} // namespace wavepath
