// First hits by rasterization: for every pixel the place of its triangle and its instance, as a camera
// ray through the same place in the pixel would find them.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "host/gpu/raster.h"
#include "host/integrators/raster/culling.h"
#include "host/integrators/raster/slices.h"
#include "host/render/device/device_scene.h"
#include "host/render/device/kernel_set.h"
#include "host/render/device/wave_queue.h"
#include "host/scene/pack/pack.h"
#include "host/scene/view.h"

namespace wavepath {

// A view as the device has it.
gpu::CameraView camera_of(const PackedScene& scene, const View& view);

// HybridFrame::near and ::far of a view.
struct ClipPlanes {
  float near = 0.0f, far = 0.0f;
};
ClipPlanes clip_planes(const PackedScene& scene, const View& view);

// Whether rasterization puts the edges of such a scene where they belong, to a quarter of a pixel.
bool edges_hold(const PackedScene& scene, const View& view, std::uint32_t width, std::uint32_t height);

class Visibility {
public:
  // `frame` and `hybrid` hold a gpu::Frame and a gpu::HybridFrame, which every render reads anew; with `gpu_scene` they
  // outlive this. `features`: kFeature bits that the path tracer's kernels have. Throws Error if the device cannot
  // rasterize, or no picture of this size. `cull` (kCull*): whether single-sided surfaces are there from behind.
  Visibility(Device& device, const PackedScene& scene, const DeviceScene& gpu_scene, const Buffer& frame,
             const Buffer& hybrid, gpu::Feature features, std::uint32_t width, std::uint32_t height,
             std::uint32_t cull = gpu::kCullCamera);

  // Submits drawing of what `camera`, the frame's own, may see; what `prepare` records comes first.
  void render(WaveQueue& queue, const gpu::CameraView& camera, const std::function<void(Commands&)>& prepare);
  // The same by tracing the frame's camera rays; for views whose edges rasterization cannot place, and to compare.
  void trace(WaveQueue& queue, const std::function<void(Commands&)>& prepare);

  // For kBindVisibility: two words a pixel, row by row from the top left.
  const Buffer& ids() const { return ids_; }
  std::uint64_t bytes() const { return ids_.bytes() + target_.bytes(); }

private:
  Device& device_;
  std::array<std::uint32_t, gpu::kSpecCount> constants_;
  std::uint32_t width_, height_;
  RasterTarget target_;
  Buffer ids_, unused_;
  BindingSet bindings_;
  RasterPipeline pipeline_;
  std::vector<Chunk> chunks_;
  std::optional<Kernel> tracer_; // compiled when it is needed
  SliceLength triangles_a_slice_, pixels_a_slice_;
};

} // namespace wavepath
