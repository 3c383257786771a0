// Unidirectional path tracing: camera rays, next-event estimation, multiple importance sampling. Its pilots learn which
// lights reach where, and then where light comes from.
#pragma once

#include <optional>

#include "host/integrators/path/guiding.h"
#include "host/integrators/path/light_teacher.h"
#include "host/integrators/path/paths.h"

namespace wavepath {

class PathTracer : public Integrator {
public:
  PathTracer(Workspace& workspace, KernelCompiler& kernels)
      : workspace_(workspace), kernels_(kernels), paths_(workspace, kernels), teacher_(workspace, kernels, paths_) {}

  void change(const View& view, const RenderPlan& settings, Past past) override;
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
  void learn_guide();
  void use_field(const GuideField& field);

  Workspace& workspace_;
  KernelCompiler& kernels_;
  Paths paths_;
  LightTeacher teacher_;
  RenderPlan settings_;
  Lesson lesson_ = Lesson::none;              // that the pilot in progress, or the next one, is for
  std::optional<GuidePilot> guide_pilot_;     // until it has learned
  std::optional<GuideReport> guide_report_;   // once it has learned
  KernelNeed guided_need_, guide_pilot_need_; // their own shade and escape kernels
};

} // namespace wavepath
