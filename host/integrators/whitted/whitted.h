// Whitted's ray tracer: the trees of a wave's camera rays, depth by depth.
#pragma once

#include <memory>
#include <vector>

#include "host/integrators/path/paths.h"
#include "kernels/whitted/whitted_types.h"

namespace wavepath {

class Whitted : public Integrator {
public:
  Whitted(Workspace& workspace, KernelCompiler& kernels);

  void change(const View& view, const RenderPlan& settings, TemporalHistory history) override;
  bool is_ready() override;
  double get_ready() override;
  std::uint32_t paths_per_pixel(std::uint32_t samples) const override { return samples * width_; }
  void begin_pass(WaveQueue&, std::uint32_t) override {}
  void record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) override;
  std::uint32_t timed_dispatches() const override;
  std::uint64_t bytes() const override { return paths_.buffers.bytes() + buffers_.bytes(); }

private:
  std::uint32_t light_passes() const; // passes over the lights at every depth

  Workspace& workspace_;
  KernelCompiler& kernels_;
  Paths paths_; // the samples of a wave, and the kernel that adds them to the film
  BufferSet buffers_;
  KernelNeed need_;
  std::uint32_t width_ = 1;                       // nodes of a tree at one depth
  std::uint32_t shadow_rays_ = 0;                 // shadow rays of a surface
  std::vector<std::unique_ptr<BindingSet>> sets_; // one for each band
};

extern const KernelProgram kWhittedProgram;
inline constexpr std::uint32_t kWhittedStages = 0xf; // all
inline constexpr gpu::Feature kWhittedLacks = gpu::kLobeDispersion | gpu::kLobeScattering | gpu::kFeatureVoxels;

// Number of rays of a sample that are followed at the same time.
std::uint32_t tree_width(const RenderPlan& settings);

} // namespace wavepath
