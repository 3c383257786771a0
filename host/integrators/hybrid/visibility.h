// First hits of a frame: the index of the triangle and of the instance for every pixel. They are rasterized, or found
// by a camera ray through the same position in the pixel. Both agree except at edges, since rasterizers round corners
// to a grid of 1/256 pixel.
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

// A view in the device's world space.
gpu::CameraView camera_of(const PackedScene& scene, const View& view);

// Values of HybridFrame::near and ::far for a view.
struct ClipPlanes {
  float near = 0.0f, far = 0.0f;
};
ClipPlanes clip_planes(const PackedScene& scene, const View& view);

// True if rasterization places the edges of such a scene to within a quarter of a pixel.
bool edges_hold(const PackedScene& scene, const View& view, std::uint32_t width, std::uint32_t height);

class Visibility {
public:
  // `frame` and `hybrid` hold a gpu::Frame and a gpu::HybridFrame, which every render reads again; they and `gpu_scene`
  // must outlive this object. `features`: kFeature bits of the path tracer's kernels. `rasterizes`: false = rays are
  // traced. `cull`: kCull constant, whether single-sided surfaces are visible from behind. `moves`: the frame is of the
  // middle of the shutter, for traced rays alone. Throws Error if the device cannot rasterize but must, or cannot hold
  // a picture of this size.
  Visibility(Device& device, const PackedScene& scene, const DeviceScene& gpu_scene, const Buffer& frame,
             const Buffer& hybrid, gpu::Feature features, std::uint32_t width, std::uint32_t height, bool rasterizes,
             std::uint32_t cull = gpu::kCullCamera, bool moves = false);

  // Submits the work that finds what `camera` sees, which must be the frame's camera. `prepare`: records commands that
  // run before. `part`: of the same camera, for rasterization.
  void render(WaveQueue& queue, const gpu::CameraView& camera, const std::function<void(Commands&)>& prepare,
              const ShownPart& part = {});

  // Buffer for kBindVisibility: two words a pixel, row by row from the top left.
  const Buffer& ids() const { return ids_; }
  std::uint64_t bytes() const { return ids_.bytes() + (raster_ ? raster_->target.bytes() : 0); }

private:
  struct Raster {
    RasterTarget target;
    RasterPipeline pipeline;
    std::vector<Chunk> chunks;
  };
  void draw(WaveQueue& queue, const gpu::CameraView& camera, const std::function<void(Commands&)>& prepare,
            const ShownPart& part);
  void trace(WaveQueue& queue, const std::function<void(Commands&)>& prepare);

  std::uint32_t width_, height_;
  Buffer ids_, unused_;
  BindingSet bindings_;
  std::unique_ptr<Raster> raster_; // null if rays are traced
  std::optional<Kernel> tracer_;
  SliceLength triangles_a_slice_, pixels_a_slice_;
};

} // namespace wavepath
