// First hits of a frame: for every pixel the indices of its triangle and its instance, rasterized, or found by a
// camera ray through the same position in the pixel. Both see the same but for edges that fall between two positions of
// the grid of 1/256 pixel which rasterizers round corners to.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "host/gpu/raster.h"
#include "host/integrators/hybrid/raster/culling.h"
#include "host/integrators/hybrid/raster/slices.h"
#include "host/render/workspace/device_scene.h"
#include "host/render/workspace/kernel_set.h"
#include "host/render/workspace/wave_queue.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"

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
  // outlive this. `features`: kFeature bits that the path tracer's kernels have. `rasterizes`: else rays are traced.
  // Throws Error if the device cannot rasterize though it is to, or no picture of this size. `cull` (kCull*): whether
  // single-sided surfaces are there from behind.
  Visibility(Device& device, const PackedScene& scene, const DeviceScene& gpu_scene, const Buffer& frame,
             const Buffer& hybrid, gpu::Feature features, std::uint32_t width, std::uint32_t height, bool rasterizes,
             std::uint32_t cull = gpu::kCullCamera);

  // Submits what finds what `camera`, the frame's own, sees; what `prepare` records comes first.
  void render(WaveQueue& queue, const gpu::CameraView& camera, const std::function<void(Commands&)>& prepare);

  // For kBindVisibility: two words a pixel, row by row from the top left.
  const Buffer& ids() const { return ids_; }
  std::uint64_t bytes() const { return ids_.bytes() + (raster_ ? raster_->target.bytes() : 0); }

private:
  struct Raster {
    RasterTarget target;
    RasterPipeline pipeline;
    std::vector<Chunk> chunks;
  };
  void draw(WaveQueue& queue, const gpu::CameraView& camera, const std::function<void(Commands&)>& prepare);
  void trace(WaveQueue& queue, const std::function<void(Commands&)>& prepare);

  std::uint32_t width_, height_;
  Buffer ids_, unused_;
  BindingSet bindings_;
  std::unique_ptr<Raster> raster_; // one of the two
  std::optional<Kernel> tracer_;
  SliceLength triangles_a_slice_, pixels_a_slice_;
};

} // namespace wavepath
