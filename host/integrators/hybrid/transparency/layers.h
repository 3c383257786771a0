// A technique of layers at work: draws the triangles of layers of a hybrid frame into kBindLayers, from which they are
// put in front of what is opaque.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/gpu/raster.h"
#include "host/integrators/hybrid/raster/slices.h"
#include "host/integrators/hybrid/transparency/layer_list.h"
#include "host/integrators/hybrid/transparency/technique.h"
#include "host/render/workspace/kernel_set.h"
#include "host/render/workspace/wave_queue.h"
#include "host/render/workspace/workspace.h"

namespace wavepath {

// Buffers of a hybrid frame that layers are drawn from and into; they outlive what uses them.
struct LayerFrame {
  const Buffer& hybrid;  // gpu::HybridFrame
  const Buffer& gbuffer; // of what is opaque
  const Buffer& seen;    // kBindSeen, of the same
  const Buffer& layers;  // kBindLayers
};

// Device memory for each pixel, kBindLayers included.
std::uint64_t layer_bytes_per_pixel(const LayerRecipe& recipe);

class Layers {
public:
  // `config`: of the path tracer's kernels. Throws Error if the device cannot draw or hold it.
  Layers(Workspace& workspace, const LayerRecipe& recipe, const KernelConfig& config, const LayerFrame& frame,
         const RenderPlan& settings);

  // Puts the triangles in order for a view.
  void turn_to(const gpu::CameraView& camera);
  // Submits drawing, behind the G-buffer of the frame. The layers are there afterwards.
  void render(WaveQueue& queue);

  std::size_t triangle_count() const { return list_.size(); }
  std::uint64_t bytes() const;

private:
  std::vector<Binding> bindings(const LayerFrame& frame) const;
  void record_finish(Commands& commands, std::uint32_t pass);

  Workspace& workspace_;
  const LayerRecipe& recipe_;
  const Buffer& layers_;
  std::uint32_t pixels_, passes_;
  std::vector<LayerTriangle> list_;
  std::array<std::uint32_t, gpu::kSpecCount> constants_;
  Buffer triangles_, unused_;
  std::vector<Buffer> copies_; // by index in LayerRecipe::bindings
  RasterTarget target_;
  BindingSet bindings_;
  RasterPipeline pipeline_;
  std::optional<Kernel> finish_;
  SliceLength triangles_a_slice_;
};

} // namespace wavepath
