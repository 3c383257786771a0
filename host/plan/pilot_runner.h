// Runs pilots of one scene on one device: uploads the scene once, and defines the cost that all decisions compare.
#pragma once

#include <memory>

#include "host/base/clock.h"
#include "host/gpu/device_class.h"
#include "host/plan/decision.h"
#include "host/plan/pilots.h"
#include "host/render/loop/render_loop.h"
#include "host/render/pilot_picture.h"
#include "host/render/render.h"
#include "host/scene/staging/view.h"

namespace wavepath {

// Result of a pilot. Work is counted, never timed: rays by kind, weighed by constants of the device type
// (IntegratorKind::work). So decisions do not depend on a clock.
struct PilotRender {
  RenderPlan settings; // settings that the pilot was rendered with
  RenderResult result;
  PictureLight light;
  double steady_work = 0.0;   // work of its samples; unit: one camera ray of `path`
  double training_work = 0.0; // work of the training before its first sample; same unit

  double squared_error() const { return result.error.relative_rms * result.error.relative_rms; }
  // Work to reach a given error: squared error times work. It does not depend on the number of samples, since error
  // squared falls as 1 / samples.
  double cost() const { return squared_error() * steady_work; }
};

// True if the render is long enough to make pilots at all, and has at least row.render_over_pilots times the paths of
// all pictures of the row and of their training. `device`: class of the device that renders.
bool is_affordable(const PilotRow& row, const RenderPlan& render, DeviceClass device, double training_paths = 0.0);

// State of a PilotRunner before a decision.
struct PilotStart {
  Clock::time_point time;
  double render_seconds, paths; // sums over all earlier pilots
};

// What the pilots of a row would decide, before they are made.
Decision to_be_tried(const PilotRow& row, const RenderPlan& render, DeviceClass device);

class PilotRunner {
public:
  // Keeps references to all arguments, which must outlive this object. `shared`: receives the uploaded scene.
  PilotRunner(Device& device, const PackedScene& scene, const View& view, KernelCompiler& kernels,
              SceneOnDevice& shared);

  // Settings of a pilot of the row: those of the render, for a smaller picture.
  static RenderPlan settings_of(const PilotRow& row, const RenderPlan& render);
  static PilotPicture picture_of(const PilotRow& row, const RenderPlan& render);
  // Paths of all pictures of a row together.
  static double paths_of_all(const PilotRow& row, const RenderPlan& render);

  // Renders a pilot. Consecutive pilots by the same integrator share buffers. The first pilot that trains its choice of
  // lights trains for all. Throws DeviceLimit if the device cannot run it.
  PilotRender run(RenderPlan pilot);
  PilotStart start() const { return {Clock::now(), render_seconds_, paths_}; }
  // Seconds and paths of the pilots of a row since `start`; the paths as a fraction of the render's.
  PilotOutcome outcome_since(const PilotStart& start, const PilotRow& row, const RenderPlan& render) const;

  Device& device() { return device_; }
  const PackedScene& scene() const { return scene_; }
  const View& view() const { return view_; }
  KernelCompiler& kernels() { return kernels_; }
  SceneOnDevice& shared() { return shared_; }
  DeviceClass device_class() const { return device_class_; }

private:
  Device& device_;
  const PackedScene& scene_;
  const View& view_;
  KernelCompiler& kernels_;
  SceneOnDevice& shared_;
  DeviceClass device_class_;
  double render_seconds_ = 0.0; // of all pilots so far
  double paths_ = 0.0;          // likewise, with those that trained
  std::unique_ptr<RenderLoop> loop_;
};

} // namespace wavepath
