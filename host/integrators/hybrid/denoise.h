// Filter over space and time (SVGF: Schied et al. 2017) of the hybrid integrator's noisy signals: direct light and
// ambient occlusion.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "host/gpu/commands.h"
#include "host/integrators/hybrid/filter_bands.h"
#include "host/render/workspace/resources.h"
#include "kernels/hybrid/filter_types.h"

namespace wavepath {

class Denoiser {
public:
  // `gbuffer`: gpu::GbufferPixel, row-major, of the frame that record() filters. `signals`: vec4, row-major: direct
  // light in xyz, unoccluded fraction in w. `wanted`: the signals to filter, kHybridLights, kHybridAmbient or both; the
  // other is left unchanged. Both buffers must outlive the denoiser.
  Denoiser(Device& device, std::uint32_t width, std::uint32_t height, const Buffer& gbuffer, const Buffer& signals,
           std::uint32_t wanted);
  Denoiser(Denoiser&&) = delete;

  // Filters `signals` in place and keeps the frame for the next one. `now`: camera of its G-buffer; the geometry must
  // not move. Barriers before and after are not needed. Leaves its own bindings bound.
  void record(Commands& commands, const gpu::CameraView& now);
  // Forgets earlier frames, after a cut or a change of what is shown.
  void forget();

  static std::uint64_t bytes_per_pixel(); // of device memory, as bytes()
  std::uint64_t bytes() const { return buffers_.bytes(); }
  std::uint32_t dispatches() const; // upper limit for record()

private:
  // Own buffers. From kShapes on they are pairs: one of this frame and one of the frame before, which take turns; the
  // two guides take turns within a frame.
  enum OwnBuffer {
    kReprojection,
    kSlopes,
    kFirstOutput,
    kFiltered,
    kShapes,
    kMoments = 6,
    kHistory = 8,
    kGuide = 10,
    kExcess = 12,
    kSpreading
  };
  enum Stage { kTemporal, kVariance, kAtrous, kSplit, kSpread, kReturn };
  // Inputs and outputs of each dispatch: temporal and variance filter after motion (kMoving) or without (kStanding);
  // the iterations of the a-trous filter; splitting, spreading and returning of rare bright samples.
  enum FlowName {
    kMoving,
    kStanding,
    kFirst,
    kSecond,
    kBack,
    kForth,
    kSplitFlow,
    kSpreadFirst,
    kSpreadForth,
    kSpreadBack,
    kReturnFlow,
    kFlowCount
  };
  // Five iterations, as in the paper: the filter is 125 pixels wide.
  static constexpr std::array<FlowName, 5> kIterations = {kFirst, kSecond, kBack, kForth, kBack};
  struct Flow {
    const Buffer *history_before, *color_in, *color_out, *guide_in, *guide_out;
  };
  std::vector<Binding> bindings(std::uint32_t parity, const Flow& flow) const;

  std::uint32_t width_, height_;
  bool splits_; // rare bright samples are split from the direct light
  FilterBands bands_;
  const Buffer& gbuffer_;
  BufferSet buffers_;
  std::array<std::array<std::unique_ptr<BindingSet>, kFlowCount>, 2> sets_; // by parity_
  std::vector<Kernel> kernels_;                                             // indexed by Stage
  gpu::CameraView before_{};
  bool remembers_ = false; // there is an earlier frame
  std::uint32_t parity_ = 0;
  std::uint32_t still_frames_ = 0; // frames since the camera moved
};

} // namespace wavepath
