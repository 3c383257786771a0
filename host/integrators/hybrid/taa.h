// Temporal anti-aliasing of a moving picture (Karis 2014), whose history is clipped to the colours seen now (Salvi
// 2016).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "host/gpu/commands.h"
#include "host/integrators/hybrid/filter_bands.h"
#include "host/render/workspace/resources.h"
#include "kernels/hybrid/filter_types.h"

namespace wavepath {

class Taa {
public:
  // `gbuffer`: gpu::GbufferPixel. `color`: vec4, linear. Both are row-major, of the frame that record() processes, and
  // must outlive this object. `joining`: the kernel of another way to join frames, with the same bindings; empty = TAA.
  Taa(Device& device, std::uint32_t width, std::uint32_t height, const Buffer& gbuffer, const Buffer& color,
      std::span<const KernelCode> joining = {});
  Taa(Taa&&) = delete;

  // Blends `color` with earlier frames. `now`: its camera; the geometry must not move. `place`: FilterBand::step.
  // Barriers before and after are not needed. Leaves its own bindings bound.
  void record(Commands& commands, const gpu::CameraView& now, std::uint32_t place = 0);
  // Forgets earlier frames, after a cut.
  void forget();

  // The blended frame: vec4, row-major, linear colour; w is the number of frames in it, up to ten. The same buffer
  // every frame.
  const Buffer& result() const { return buffers_[kResult]; }
  std::uint64_t bytes() const { return buffers_.bytes(); } // of device memory
  static std::uint64_t bytes_per_pixel() { return 3 * sizeof(gpu::vec4); }
  std::uint32_t dispatches() const { return bands_.count(); } // number that record() records

private:
  // KHistory is a pair: of this frame and of the frame before, which take turns.
  enum OwnBuffer { kReprojection, kResult, kHistory };
  std::uint32_t width_, height_;
  FilterBands bands_;
  BufferSet buffers_;
  std::array<std::unique_ptr<BindingSet>, 2> sets_; // by parity_
  std::unique_ptr<Kernel> kernel_;
  gpu::CameraView before_{};
  bool remembers_ = false; // there is an earlier frame
  std::uint32_t parity_ = 0;
};

} // namespace wavepath
