// Trains light selection before a render, for every integrator that follows paths.
//
// The training pass is a pilot: its samples find out which lights and which parts of the sky reach which cells of
// space, and are then discarded.
#pragma once

#include <cstdint>
#include <span>

#include "host/base/clock.h"
#include "host/integrators/path/paths.h"
#include "host/render/loop/render_result.h"

namespace wavepath {

class LightTrainer {
public:
  LightTrainer(Workspace& workspace, KernelCompiler& kernels, Paths& paths)
      : workspace_(workspace), kernels_(kernels), paths_(paths) {}

  // Adopts the settings. Called before Paths::change(), whose `options` must then include capacity().
  void change(const RenderPlan& settings);
  std::uint32_t capacity() const { return trains_ ? kCapacityForLightSums : 0; }
  // Called after Paths::change(). Begins compiling the kernels of the training pass, or copies the probabilities that
  // another render has trained.
  void start();
  bool is_ready() { return !trains_ || kernels_.ready(need_); }
  double get_ready() { return trains_ ? kernels_.best(need_).seconds() : 0.0; }

  bool trains() const { return trains_; }
  Pilot begin();                                              // until finish(), probabilities are by power
  void finish();                                              // called after the waves of the pass were waited for
  const KernelSet& kernels() { return kernels_.best(need_); } // `advance` and `connect` of the pass
  const LightTraining& report() const { return report_; }

private:
  void use(std::span<const std::uint32_t> lights, std::span<const std::uint32_t> sky);

  Workspace& workspace_;
  KernelCompiler& kernels_;
  Paths& paths_;
  bool trains_ = false;
  std::uint64_t training_paths_ = 0;        // Training::paths
  bool of_lights_ = false, of_sky_ = false; // which probabilities are in use, whoever trained them
  LightProbabilities taken_over_;
  KernelNeed need_;
  LightTraining report_;
  Clock::time_point start_{};
};

} // namespace wavepath
