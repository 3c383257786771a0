// Surface voxels on the device, with their levels: what cones are traced through. Made once, before the first frame.
#pragma once

#include <memory>
#include <vector>

#include "host/integrators/hybrid/voxels/surface_grid.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/render/workspace/resources.h"
#include "host/render/workspace/wave_queue.h"
#include "host/render/workspace/workspace.h"

namespace wavepath {

inline constexpr const char* kVoxelStage = "surface voxels";

// The kernels that make voxels.
extern const KernelProgram kVoxelProgram;

// Numbers and kinds of the bindings of kernels that trace cones: kBindSurfaceLevels, kBindSurfaceVoxels.
void add_voxel_layout(std::vector<Binding>& layout);

class SurfaceVoxels {
public:
  // Reserves memory and begins compiling. `across`: voxels along the longest side of the scene. Throws Error if the
  // device cannot hold them.
  SurfaceVoxels(Workspace& workspace, KernelCompiler& kernels, const KernelConfig& config, std::uint32_t across);

  bool is_ready() { return kernels_.ready(need_); }
  double get_ready() { return kernels_.best(need_).seconds(); } // seconds that compiling took

  // Submits what makes them, the first time.
  void build(WaveQueue& queue);
  // Adds bindings for kernels that trace cones; their buffers are this one's.
  void add_bindings(std::vector<Binding>& bindings) const;

  const SurfaceGrid& grid() const { return grid_; }
  const Buffer& words() const { return buffers_[1]; } // kBindSurfaceVoxelWords
  std::uint64_t bytes() const { return buffers_.bytes(); }

private:
  Workspace& workspace_;
  KernelCompiler& kernels_;
  KernelNeed need_;
  SurfaceGrid grid_;
  BufferSet buffers_;
  std::unique_ptr<BindingSet> set_;
  bool is_built_ = false;
};

} // namespace wavepath
