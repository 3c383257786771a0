#include "host/session/run.h"

#include <algorithm>
#include <functional>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/render/settings/settings_table.h"
#include "host/render/workspace/light_training.h"
#include "host/session/judge.h"
#include "host/session/resume.h"

namespace wavepath {
namespace {

TrueError unknown_error() {
  TrueError unknown;
  unknown.metrics.nonfinite_image = 1; // as of a picture that has no score
  return unknown;
}

// Notes in `true_errors` one for each checkpoint that this run passes.
std::function<void(const Checkpoint&, const Picture&)> measure_checkpoints(Prepared& prepared, const Picture& reference,
                                                                           std::vector<TrueError>& true_errors) {
  return [&](const Checkpoint&, const Picture& picture) {
    TrueError error = unknown_error();
    why_not_measured(prepared, "the true error was", [&] { error = measure_true_error(picture, reference); });
    true_errors.push_back(error);
  };
}

// A resumed render measures only the checkpoints that it passes itself; those before have no true error.
std::vector<TrueError> align(std::vector<TrueError> errors, std::size_t checkpoints) {
  if (errors.empty()) return errors;
  errors.insert(errors.begin(), checkpoints - std::min(errors.size(), checkpoints), unknown_error());
  return errors;
}

RenderHooks hooks_of(Prepared& prepared, const RunHooks& run, std::vector<TrueError>& true_errors) {
  RenderHooks hooks;
  hooks.progress = run.progress;
  if (run.reference) hooks.checkpoint = measure_checkpoints(prepared, *run.reference, true_errors);
  hooks.show = run.show;
  hooks.publish = run.publish;
  hooks.publish_interval = run.publish_interval;
  return hooks;
}

// Renders on all of --devices.
MultiDeviceResult render_on_devices(Prepared& prepared, const RenderHooks& hooks) {
  std::vector<RenderingDevice> devices{{prepared.device.get(), prepared.kernels.get()}};
  for (const OtherDevice& other : prepared.others) devices.push_back({other.device.get(), other.kernels.get()});
  MultiDeviceResult shared = render_by_several(devices, prepared.packed, prepared.view, prepared.plan.settings, hooks);
  if (!shared.bits_agree)
    prepared.warnings.add("the devices round differently, so that the last bits of the picture depend on their shares");
  for (const DeviceWork& work : shared.device_work)
    if (work.lost) prepared.warnings.add(work.name + ": was lost while rendering; the others took over");
  return shared;
}

// A state is of one part of a picture; parts have the identity of the whole, as they are merged.
std::string state_identity(const Prepared& prepared) {
  const std::string crop = text_of(setting_named("crop"), prepared.plan.settings);
  return crop.empty() ? prepared.identity : prepared.identity + ";crop=" + crop;
}

// Renders, from the state of --checkpoint on where --resume asks for it.
RenderResult render_prepared(const RenderRequest& request, Prepared& prepared, RenderHooks hooks) {
  const StateRequest& state = request.state;
  const DeviceInfo& device = prepared.device->info();
  const RenderPlan& settings = prepared.plan.settings;
  const std::optional<RenderState> resumed =
      read_resumed(state, settings, state_identity(prepared), device, prepared.warnings);
  if (resumed && !resumed->levels.empty()) {
    if (request.mergeable)
      throw Error(state.file, "has given noisy pixels more samples, so that its picture cannot be merged",
                  "leave out --samples and --mergeable, or begin anew with them");
  }
  if (resumed && request.mergeable) {
    const bool trained = settings.training.paths != 0 && trains_light_selection(prepared.packed, settings);
    if (trained || (settings.guide && settings.training.guide_iterations != kGuideIterations))
      throw Error(state.file, "has trained its choice of light as parts do not, so that its picture cannot be merged",
                  "leave out --samples and --mergeable, or begin anew with them");
  }
  hooks.save =
      state_saver(state, state_identity(prepared), to_line(prepared.plan.decisions), device, prepared.warnings);
  hooks.save_interval = state.interval;
  hooks.salvages = true;
  if (resumed) hooks.resume = &*resumed;
  RenderResult result =
      render(*prepared.device, prepared.packed, prepared.view, settings, hooks, *prepared.kernels, &prepared.on_device);
  result.upload_seconds = prepared.on_device.upload_seconds; // by a pilot, perhaps
  return result;
}

} // namespace

Rendered run(const RenderRequest& request, Prepared& prepared, const RunHooks& run_hooks) {
  Rendered rendered;
  std::vector<TrueError> true_errors;
  const RenderHooks hooks = hooks_of(prepared, run_hooks, true_errors);
  if (!prepared.others.empty()) {
    prepared.on_device = {}; // each device uploads it by itself
    rendered.shared = render_on_devices(prepared, hooks);
    rendered.result = std::move(rendered.shared->result);
  } else {
    rendered.result = render_prepared(request, prepared, hooks);
  }
  rendered.true_errors = align(std::move(true_errors), rendered.result.checkpoints.size());
  return rendered;
}

} // namespace wavepath
