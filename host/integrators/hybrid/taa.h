// Temporal anti-aliasing of a picture in motion (Karis 2014), its history clipped to what is seen now (Salvi 2016).
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "host/gpu/commands.h"
#include "host/integrators/hybrid/filter_bands.h"
#include "host/render/workspace/resources.h"
#include "kernels/hybrid/filter_types.h"

namespace wavepath {

class Taa {
public:
  // `gbuffer`: gpu::GbufferPixel, `color`: vec4, linear; both row-major, of the frame that record() will find, and
  // outliving this.
  Taa(Device& device, std::uint32_t width, std::uint32_t height, const Buffer& gbuffer, const Buffer& color);
  Taa(Taa&&) = delete;

  // Joins `color` to what came before. `now` is how it was seen; the geometry stands still. What wrote the inputs needs
  // no barrier, nor does what reads the result. Ends with its own bindings bound.
  void record(Commands& commands, const gpu::CameraView& now);
  // A cut: the next frame has no history.
  void forget();

  // vec4, row-major: linear colour, and in w the number of frames in it, up to ten. The same buffer every frame.
  const Buffer& result() const { return buffers_[kResult]; }
  std::uint64_t bytes() const { return buffers_.bytes(); }    // of device memory
  std::uint32_t dispatches() const { return bands_.count(); } // that record() records

private:
  enum OwnBuffer { kReprojection, kResult, kHistory }; // the last is two: of this frame and the one before, in turns
  std::uint32_t width_, height_;
  FilterBands bands_;
  BufferSet buffers_;
  std::array<std::unique_ptr<BindingSet>, 2> sets_; // by turn
  std::unique_ptr<Kernel> kernel_;
  gpu::CameraView before_{};
  bool remembers_ = false; // there is a frame before
  std::uint32_t parity_ = 0;
};

} // namespace wavepath
