// Unidirectional path tracing: camera rays, next-event estimation, multiple importance sampling.
#pragma once

#include "host/integrators/path/paths.h"

namespace wavepath {

class PathTracer : public Integrator {
public:
  PathTracer(Workspace& workspace, KernelCompiler& kernels) : workspace_(workspace), paths_(workspace, kernels) {}

  void change(const View& view, const RenderSettings& settings, Past past) override;
  bool is_ready() override { return paths_.is_ready(); }
  double get_ready() override { return paths_.get_ready(); }
  void begin_pass(WaveQueue&, std::uint32_t) override {}
  void record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) override;
  std::uint32_t timed_dispatches() const override;
  std::uint64_t bytes() const override { return paths_.buffers.bytes(); }

private:
  Workspace& workspace_;
  Paths paths_;
};

} // namespace wavepath
