// Filter of finished frames: one or several kernels, each of which reads this frame only.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "host/integrators/hybrid/filter_bands.h"
#include "host/render/workspace/resources.h"

namespace wavepath {

class FrameFilter {
public:
  // `gbuffer`: gpu::GbufferPixel. `color`: vec4, linear. Both are row-major and must outlive this object.
  FrameFilter(Device& device, std::span<const KernelCode> passes, std::uint32_t width, std::uint32_t height,
              const Buffer& gbuffer, const Buffer& color);
  FrameFilter(FrameFilter&&) = delete;

  // Filters `color` into result(). Barriers before and after are not needed. Leaves its own bindings bound.
  void record(Commands& commands);

  // The filtered colour: vec4, row-major.
  const Buffer& result() const { return buffers_[kResult]; }
  std::uint64_t bytes() const { return buffers_.bytes(); } // of device memory

private:
  enum OwnBuffer { kFrame, kResult, kEdges };
  std::uint32_t width_, height_;
  FilterBands bands_;
  BufferSet buffers_;
  std::unique_ptr<BindingSet> set_;
  std::vector<Kernel> kernels_;
};

} // namespace wavepath
