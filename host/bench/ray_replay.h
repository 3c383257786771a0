// The rays of one wave as the renderer makes them, and the kernels that trace them, any number of times.
#pragma once

#include <span>
#include <vector>

#include "host/integrators/path/paths.h"
#include "kernels/base/frame_types.h"
#include "kernels/path/path_types.h"

namespace wavepath {

struct RaySets {
  std::vector<gpu::Ray> camera, bounce;
  // The shadow rays of next-event estimation; if it sends hardly any, the bounce rays, unbounded.
  std::vector<gpu::ShadowRay> shadow;
};

class RayReplay {
public:
  // `settings` ask for capacity_for_shadow_rays. `uploaded`: the scene, if it is on the device already. `scene` and
  // `kernels` outlive this.
  RayReplay(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
            KernelCompiler& kernels, std::shared_ptr<const DeviceScene> uploaded = nullptr);

  // Seconds of uploading the scene; 0 if it was uploaded before.
  double upload_seconds() const { return workspace_.upload_seconds; }
  const DeviceScene& device_scene() const { return *workspace_.on_device; }

  // Captures the rays of the first sample of as many pixels, in tile order, as there are slots.
  RaySets capture();

  // Seconds on the device that finding the closest hits takes; at most slots() rays.
  double extend(std::span<const gpu::Ray> rays, bool from_camera);
  std::vector<gpu::Hit> hits(std::size_t count) const; // hits of the last extend
  // Distances to the hits of the last extend, infinite for a miss. `scene` is what this was made of.
  std::vector<float> distances(const PackedScene& scene, std::span<const gpu::Ray> rays) const;

  // The same for finding which shadow rays are blocked.
  double connect(std::span<const gpu::ShadowRay> rays);
  std::vector<bool> blocked(std::span<const gpu::ShadowRay> rays) const; // results of the last connect

private:
  gpu::Wave first_wave() const; // wave of the first sample of as many pixels as there are slots
  double time(PathStage stage, const gpu::Queues& queues, std::size_t count, std::uint32_t bounce);

  Workspace workspace_;
  Paths paths_;
};

} // namespace wavepath
