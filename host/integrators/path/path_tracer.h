// Unidirectional path tracing: camera rays, next-event estimation, multiple importance sampling. Its pilots train light
// selection, and then the guiding field.
#pragma once

#include <optional>

#include "host/integrators/path/guiding.h"
#include "host/integrators/path/light_trainer.h"
#include "host/integrators/path/paths.h"

namespace wavepath {

class PathTracer : public Integrator {
public:
  PathTracer(Workspace& workspace, KernelCompiler& kernels)
      : workspace_(workspace), kernels_(kernels), paths_(workspace, kernels), trainer_(workspace, kernels, paths_) {}

  void change(const View& view, const RenderPlan& settings, TemporalHistory history) override;
  bool is_ready() override;
  double get_ready() override;
  std::optional<Pilot> pilot() override;
  bool end_pilot() override;
  void begin_pass(WaveQueue&, std::uint32_t) override {}
  void record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) override;
  std::uint32_t timed_dispatches() const override;
  std::uint64_t bytes() const override { return paths_.buffers.bytes(); }
  void describe(RenderResult& result) const override;

private:
  enum class Training { none, lights, guide };

  std::uint32_t capacity() const; // bits of BufferDimensions::options that training and trained data need
  void train_guide();
  void use_field(const GuideField& field);

  Workspace& workspace_;
  KernelCompiler& kernels_;
  Paths paths_;
  LightTrainer trainer_;
  RenderPlan settings_;
  Training training_ = Training::none;           // purpose of the pilot in progress, or of the next one
  std::optional<GuideTraining> guide_training_;  // empty once training has ended
  std::optional<GuideReport> guide_report_;      // empty until training has ended
  KernelNeed guided_need_, guide_training_need_; // `shade` and `escape` of guided paths, and of guide training
};

} // namespace wavepath
