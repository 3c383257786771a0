// Predicts the memory that a render needs besides its scene. `info` lists the items; a render whose items do not fit is
// refused before anything is allocated.
#pragma once

#include <string>
#include <vector>

#include "host/base/memory.h"
#include "host/gpu/device_info.h"
#include "host/render/settings/memory_item.h"
#include "host/render/settings/render_plan.h"
#include "host/scene/pack/plan.h"

namespace wavepath {

struct MemoryPlan {
  std::vector<MemoryItem> render; // items of the render as a whole, without paths in flight
  std::vector<MemoryItem> path;   // items of one path in flight
};

// Lists only what this scene and these settings use. `features`: kFeature bits of the scene, known or expected.
MemoryPlan plan_memory(const RenderPlan& settings, const ScenePlan& scene, gpu::Feature features);

std::uint64_t total_bytes(const std::vector<MemoryItem>& items);

// Checks that the host has memory for the packed scene and the host's part of a render; on a CPU device, for the
// device's buffers as well. It is made before the scene is packed, and can be asked again after pilots have changed the
// settings.
class MemoryCheck {
public:
  MemoryCheck(std::string file, const ScenePlan& scene, gpu::Feature features, DeviceInfo device,
              std::uint64_t available = available_memory());

  std::uint64_t bytes(const RenderPlan& settings) const;
  bool fits(const RenderPlan& settings) const { return bytes(settings) <= available_; }
  void require(const RenderPlan& settings) const; // throws Error unless it fits

private:
  std::string file_;
  ScenePlan scene_;
  gpu::Feature features_;
  DeviceInfo device_;
  std::uint64_t available_;
};

} // namespace wavepath
