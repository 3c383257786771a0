// A filter of finished frames, one kernel or several after each other, each seeing no frame but this one.
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
  // `gbuffer`: gpu::GbufferPixel, `color`: vec4, linear; both row-major, and outliving this.
  FrameFilter(Device& device, std::span<const KernelCode> passes, std::uint32_t width, std::uint32_t height,
              const Buffer& gbuffer, const Buffer& color);
  FrameFilter(FrameFilter&&) = delete;

  // Filters `color` into result(). What wrote the inputs needs no barrier, nor does what reads the result. Ends with
  // its own bindings bound.
  void record(Commands& commands);

  // vec4, row-major.
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
