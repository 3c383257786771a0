// Unidirectional path tracing: camera rays, next-event estimation, multiple importance sampling. Its pilots learn which
// lights reach where, and then where light comes from.
#pragma once

#include <optional>

#include "host/base/clock.h"
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
  std::uint64_t bytes() const override { return paths_.buffers.bytes(); }
  void describe(RenderResult& result) const override;

private:
  enum class Lesson { none, lights, guide };

  std::uint32_t rooms() const; // bits of Extent::options for what is learned and used
  Pilot begin_light_pilot();
  void learn_lights();
  void learn_guide();
  void use_field(const GuideField& field);

  Workspace& workspace_;
  KernelCompiler& kernels_;
  Paths paths_;
  RenderSettings settings_;
  Lesson lesson_ = Lesson::none; // that the pilot in progress, or the next one, is for
  bool learns_lights_ = false;
  LightPilot light_pilot_;
  Clock::time_point light_pilot_start_{};
  std::optional<GuidePilot> guide_pilot_;     // until it has learned
  std::optional<GuideReport> guide_report_;   // once it has learned
  KernelNeed light_pilot_need_;               // its own connect kernel
  KernelNeed guided_need_, guide_pilot_need_; // their own shade kernels
};

} // namespace wavepath
