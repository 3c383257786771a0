// The light that leaves surface voxels, and its levels. Made once, before the first frame: neither surfaces nor lights
// move.
#pragma once

#include <memory>
#include <vector>

#include "host/integrators/hybrid/voxels/surface_voxels.h"

namespace wavepath {

inline constexpr const char* kVoxelLightStage = "light of voxels";

// The kernels that light voxels.
extern const KernelProgram kVoxelLightProgram;

// Numbers and kinds of the bindings of kernels that look lit voxels up: those of surface voxels, and the light.
void add_voxel_light_layout(std::vector<Binding>& layout);

// The most bytes that the light of such voxels takes: of those of a cube.
std::uint64_t most_voxel_light_bytes(std::uint32_t across);

class LitVoxels {
public:
  // Reserves memory and begins compiling. `config`: of the path tracer's kernels. `voxels` outlive it. Throws Error if
  // the device cannot hold the light.
  LitVoxels(Workspace& workspace, KernelCompiler& kernels, const KernelConfig& config, const SurfaceVoxels& voxels);

  bool is_ready() { return kernels_.ready(need_); }
  double get_ready() { return kernels_.best(need_).seconds(); } // seconds that compiling took

  // Submits what lights them, the first time; behind what makes the voxels.
  void build(WaveQueue& queue);
  // Adds bindings for kernels that look them up; their buffers are this one's and those of the voxels.
  void add_bindings(std::vector<Binding>& bindings) const;
  std::uint64_t bytes() const { return buffers_.bytes(); }

private:
  void submit_voxels(WaveQueue& queue, std::size_t kernel, std::uint32_t level, std::uint64_t most);

  Workspace& workspace_;
  KernelCompiler& kernels_;
  KernelNeed need_;
  const SurfaceVoxels& voxels_;
  BufferSet buffers_;
  std::unique_ptr<BindingSet> set_;
  bool is_built_ = false;
};

} // namespace wavepath
