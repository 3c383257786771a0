// Makes pilots of one scene on one device: one upload, one definition of what a given error costs.
#pragma once

#include <memory>

#include "host/plan/decision.h"
#include "host/plan/pilots.h"
#include "host/render/loop/render_loop.h"
#include "host/render/pilot_picture.h"
#include "host/render/render.h"
#include "host/scene/staging/view.h"

namespace wavepath {

// A pilot that was made. Work is counted, never timed: rays by kind, weighed by constants of the type of device
// (IntegratorKind::work), so that what is decided depends on no clock.
struct PilotRender {
  RenderPlan settings; // of the pilot
  RenderResult result;
  PictureLight light;
  double steady_work = 0.0;   // of its samples, in camera rays
  double training_work = 0.0; // of what was learned before the first of them

  double squared_error() const { return result.error.relative_rms * result.error.relative_rms; }
  // What a given error costs: squared error times work, which is the same for any number of samples.
  double cost() const { return squared_error() * steady_work; }
};

// Whether the render is long enough for any pilot, and has so many times the paths of the pictures of a row as the row
// asks for.
bool is_affordable(const PilotRow& row, const RenderPlan& render, bool cpu);

class PilotRunner {
public:
  // All but `shared`, to which the scene is uploaded, must outlive this.
  PilotRunner(Device& device, const PackedScene& scene, const View& view, KernelCompiler& kernels,
              SceneOnDevice& shared);

  // The settings of a pilot: the render's own for a small picture.
  static RenderPlan settings_of(const PilotRow& row, const RenderPlan& render);
  static PilotPicture picture_of(const PilotRow& row, const RenderPlan& render);
  // Paths that all pictures of a row have.
  static double paths_of_all(const PilotRow& row, const RenderPlan& render);

  // Renders it. Pilots by the same integrator share buffers. Throws DeviceLimit where the device cannot run it.
  PilotRender run(const RenderPlan& pilot);

  Device& device() { return device_; }
  const PackedScene& scene() const { return scene_; }
  const View& view() const { return view_; }
  KernelCompiler& kernels() { return kernels_; }
  SceneOnDevice& shared() { return shared_; }
  bool is_cpu() const { return cpu_; }
  double render_seconds() const { return render_seconds_; } // of all pilots so far

private:
  Device& device_;
  const PackedScene& scene_;
  const View& view_;
  KernelCompiler& kernels_;
  SceneOnDevice& shared_;
  bool cpu_;
  double render_seconds_ = 0.0;
  std::unique_ptr<RenderLoop> loop_;
};

} // namespace wavepath
