// Visibility of frames that each see one part of every pixel: the triangles that a beam of camera rays meets, and the
// fractions of the pixel that show them (Heckbert and Hanrahan 1984; as cones, Amanatides 1984).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "host/integrators/hybrid/raster/slices.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/render/workspace/wave_queue.h"
#include "host/render/workspace/workspace.h"
#include "kernels/hybrid/antialias/beam_types.h"

namespace wavepath {

extern const KernelProgram kBeamProgram;

class Beams {
public:
  // `shape`: kBeam constant. Throws Error if the device traces rays by its own means, which know no beams.
  Beams(Workspace& workspace, KernelCompiler& kernels, std::uint32_t shape);

  // Begins compiling and reserves memory. The buffers outlive this: `hybrid` (kBindHybrid), `fractions`
  // (kBindFractions), `visible` (kBindVisibility). Nothing may be in flight.
  void change(const KernelConfig& config, const Buffer& hybrid, const Buffer& fractions, const Buffer& visible);
  bool is_ready() { return kernels_.ready(need_); }
  double get_ready() { return kernels_.best(need_).seconds(); } // seconds that compiling took

  // Submits what finds the parts of all pixels, and their fractions; its time is counted as `stage`.
  void find(WaveQueue& queue, const char* stage, const std::function<void(Commands&)>& prepare);
  // Submits what makes a part of every pixel, one of kFractions, what the frame sees.
  void show(WaveQueue& queue, std::uint32_t part, const std::function<void(Commands&)>& prepare);

  // Most bytes of the lists of triangles, of which there are enough for a slice. The pictures come to them.
  static std::uint64_t most_list_bytes();
  std::uint64_t bytes() const { return triangles_.bytes() + areas_.bytes() + ids_.bytes(); }

private:
  Workspace& workspace_;
  KernelCompiler& kernels_;
  const std::uint32_t shape_;
  KernelNeed need_;
  Buffer triangles_, areas_, ids_;
  std::unique_ptr<BindingSet> set_;
  SliceLength work_a_slice_;
};

} // namespace wavepath
