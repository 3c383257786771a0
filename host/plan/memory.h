// What a render takes of memory besides its scene: `info` tells it item by item, and what does not fit is refused by
// the same items before any of it is allocated.
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
  std::vector<MemoryItem> render; // without paths in flight
  std::vector<MemoryItem> path;   // of each path in flight
};

// Only what this scene and these settings use. `features`: kFeature bits of the scene, or those expected of it.
MemoryPlan plan_memory(const RenderPlan& settings, const ScenePlan& scene, gpu::Feature features);

std::uint64_t total_bytes(const std::vector<MemoryItem>& items);

// Whether the host holds the packed scene with what a render keeps there; of a CPU device its buffers as well. Made
// before the scene is packed, it can still be asked when pilots have decided about the render.
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
