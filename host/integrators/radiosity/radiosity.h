// Radiosity: diffuse light between patches, solved once for all views, and the camera rays that show it.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "host/integrators/path/paths.h"
#include "host/integrators/radiosity/solver.h"

namespace wavepath {

class Radiosity : public Integrator {
public:
  Radiosity(Workspace& workspace, KernelCompiler& kernels);

  void change(const View& view, const RenderPlan& settings, TemporalHistory history) override;
  bool is_ready() override;
  double get_ready() override;
  std::optional<Pilot> pilot() override;
  bool end_pilot() override;
  void begin_pass(WaveQueue& queue, std::uint32_t first_sample) override;
  void record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) override;
  std::uint32_t timed_dispatches() const override { return 4; }
  std::uint64_t bytes() const override { return paths_.buffers.bytes() + seen_.bytes() + solver_.bytes(); }
  void describe(RenderResult& result) const override;

private:
  // Settings that a solution depends on. It serves every view.
  using Key = std::array<std::uint32_t, 10>;

  void bind();

  Workspace& workspace_;
  KernelCompiler& kernels_;
  Paths paths_; // the samples of a wave, and the kernel that adds them to the film
  Buffer seen_; // SeenPoint of each slot
  Solver solver_;
  KernelNeed need_;
  RenderPlan settings_;
  Key key_{};                                     // of the settings
  std::optional<Key> solved_;                     // none: nothing is solved
  bool serves_again_ = false;                     // the solution of an earlier view
  bool is_solving_ = false;                       // in a pilot
  std::vector<std::unique_ptr<BindingSet>> sets_; // one for each band
};

extern const KernelProgram kRadiosityProgram;
// Kernels of what the settings ask for, in a scene of these features.
KernelNeed radiosity_need(const KernelConfig& config, const RenderPlan& settings);

// Reason why the scene cannot be rendered; empty if it can.
std::string radiosity_lacks(const RenderPlan& settings, const PackedScene& scene);

} // namespace wavepath
