// Unidirectional path tracing: camera rays, next-event estimation, multiple importance sampling.
#pragma once

#include "host/base/clock.h"
#include "host/integrators/path/paths.h"
#include "host/render/loop/render_result.h"

namespace wavepath {

class PathTracer : public Integrator {
public:
  PathTracer(Workspace& workspace, KernelCompiler& kernels)
      : workspace_(workspace), kernels_(kernels), paths_(workspace, kernels) {}

  void change(const View& view, const RenderSettings& settings, Past past) override;
  bool is_ready() override;
  double get_ready() override;
  std::optional<Pilot> pilot() override;
  void learn() override;
  void begin_pass(WaveQueue&, std::uint32_t) override {}
  void record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) override;
  std::uint32_t timed_dispatches() const override;
  std::uint64_t bytes() const override { return paths_.buffers.bytes(); }
  void describe(RenderResult& result) const override;

private:
  Workspace& workspace_;
  KernelCompiler& kernels_;
  Paths paths_;
  KernelNeed pilot_need_; // of its shadow rays alone
  bool learns_ = false, exploring_ = false;
  LightPilot pilot_;
  Clock::time_point pilot_start_{};
};

} // namespace wavepath
