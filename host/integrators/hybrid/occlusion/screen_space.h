// Ambient occlusion of a whole frame from its G-buffer, and from surface voxels if the technique looks at them: one
// kernel over all pixels, after the last wave of the frame.
#pragma once

#include <memory>
#include <vector>

#include "host/integrators/hybrid/occlusion/technique.h"
#include "host/integrators/hybrid/raster/slices.h"
#include "host/render/loop/frame_times.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/render/workspace/workspace.h"

namespace wavepath {

inline constexpr const char* kScreenOcclusionStage = "screen-space occlusion";

// Numbers and kinds of the bindings of its kernels.
std::vector<Binding> screen_space_layout();

class ScreenSpaceOcclusion {
public:
  ScreenSpaceOcclusion(Workspace& workspace, KernelCompiler& kernels, const OcclusionKind& kind);

  // Begins compiling. `frame`: buffers of kBindHybrid, kBindGbuffer, kBindSignals, and of voxels if the technique needs
  // them. They outlive this.
  void change(const KernelConfig& config, const std::vector<Binding>& frame);
  bool is_ready() { return kernels_.ready(need_); }
  double get_ready() { return kernels_.best(need_).seconds(); } // seconds that compiling took

  // Submits what turns the G-buffer of the frame into the unoccluded fraction, the w of its signals.
  void submit(WaveQueue& queue);

  FrameCost cost() const { return times_.cost(); }

private:
  const char* stage() const { return kind_.program->stages.front().name; } // its time is counted under this name

  Workspace& workspace_;
  KernelCompiler& kernels_;
  const OcclusionKind& kind_;
  KernelNeed need_;
  std::unique_ptr<BindingSet> set_;
  SliceLength pixels_a_slice_;
  FrameTimes times_;
};

} // namespace wavepath
