#include "host/plan/pilot_runner.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/gpu/device.h"
#include "host/render/pilot_work.h"
#include "host/render/settings/integrator_kind.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {

bool is_affordable(const PilotRow& row, const RenderPlan& render, DeviceClass device, double training_paths) {
  const double paths = PilotRunner::paths_of_all(row, render) + training_paths;
  return may_make_pilots(render, device) && expected_paths(render, device) >= row.render_over_pilots * paths;
}

Decision to_be_tried(const PilotRow& row, const RenderPlan& render, DeviceClass device) {
  Decision decision{.what = row.decides, .taken = "auto"};
  decision.pilot = PilotRunner::picture_of(row, render);
  decision.fraction = PilotRunner::paths_of_all(row, render) / expected_paths(render, device);
  decision.why = fmt::format("pilots of {}x{} pixels, {} samples, decide", decision.pilot.width, decision.pilot.height,
                             row.samples);
  return decision;
}

PilotRunner::PilotRunner(Device& device, const PackedScene& scene, const View& view, KernelCompiler& kernels,
                         SceneOnDevice& shared)
    : device_(device),
      scene_(scene),
      view_(view),
      kernels_(kernels),
      shared_(shared),
      device_class_(class_of(device.info())) {}

RenderPlan PilotRunner::settings_of(const PilotRow& row, const RenderPlan& render) {
  RenderPlan pilot = pilot_settings(render, row.side, row.samples);
  pilot.seed = render.seed ^ row.seed;
  return pilot;
}

PilotPicture PilotRunner::picture_of(const PilotRow& row, const RenderPlan& render) {
  const RenderPlan pilot = settings_of(row, render);
  return {pilot.width, pilot.height, row.samples};
}

double PilotRunner::paths_of_all(const PilotRow& row, const RenderPlan& render) {
  return row.pictures * paths_of(settings_of(row, render));
}

PilotOutcome PilotRunner::outcome_since(const PilotStart& start, const PilotRow& row, const RenderPlan& render) const {
  return {.seconds = seconds_since(start.time),
          .render_seconds = render_seconds_ - start.render_seconds,
          .pilot = picture_of(row, render),
          .fraction = (paths_ - start.paths) / expected_paths(render, device_class_)};
}

PilotRender PilotRunner::run(RenderPlan pilot) {
  if (!pilot.training.found) pilot.training.found = shared_.light_probabilities;
  std::unique_ptr<RenderLoop> loop = std::move(loop_); // one that throws is of no use any more
  if (loop && loop->settings().integrator == pilot.integrator) {
    loop->restart(view_, pilot);
  } else {
    loop.reset(); // the device may not hold both at once
    loop = std::make_unique<RenderLoop>(device_, scene_, view_, pilot, kernels_, RenderHooks{}, LoopPolicy{},
                                        shared_.scene);
  }
  if (!shared_.scene) {
    shared_.scene = loop->workspace().on_device;
    shared_.upload_seconds = loop->workspace().upload_seconds;
  }
  while (loop->step()) {
  }
  PilotRender made{.settings = pilot, .result = loop->finish()};
  if (made.result.light_training.probabilities) shared_.light_probabilities = made.result.light_training.probabilities;
  render_seconds_ += made.result.seconds;
  paths_ += paths_of(pilot) + static_cast<double>(made.result.light_training.paths);
  made.light = light_of(*made.result.film);
  made.steady_work = steady_work(pilot, made.result, device_class_);
  made.training_work = std::max(0.0, pilot.integrator->work(pilot, made.result.rays, device_class_) - made.steady_work);
  loop_ = std::move(loop);
  return made;
}

} // namespace wavepath
