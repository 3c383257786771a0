// Unidirectional path tracing: camera rays, next-event estimation, multiple importance sampling.
#pragma once

#include <optional>

#include "host/integrators/path/guiding.h"
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
  bool learn() override;
  void begin_pass(WaveQueue&, std::uint32_t) override {}
  void record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) override;
  std::uint32_t timed_dispatches() const override;
  void describe(RenderResult& result) const override { result.guide = guide_report_; }
  std::uint64_t bytes() const override { return paths_.buffers.bytes(); }

private:
  void use_field(const GuideField& field);

  Workspace& workspace_;
  KernelCompiler& kernels_;
  Paths paths_;
  RenderSettings settings_;
  std::optional<GuidePilot> guide_pilot_;   // while it learns
  std::optional<GuideReport> guide_report_; // once it has learned
  KernelNeed guided_need_, pilot_need_;     // their own shade kernels
};

} // namespace wavepath
