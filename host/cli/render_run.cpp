#include "host/cli/render_run.h"

#include <algorithm>
#include <functional>
#include <new>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/print.h"
#include "host/cli/commands.h"
#include "host/cli/interrupt.h"
#include "host/cli/progress.h"
#include "host/cli/report.h"
#include "host/cli/resume.h"
#include "host/cli/trace_report.h"
#include "host/gpu/pipeline_cache.h"
#include "host/render/settings/settings_table.h"
#include "host/render/workspace/light_training.h"

namespace wavepath {
namespace {

// `begin`: of the hooks, with progress on the terminal and interrupts.
template <class Begin>
auto render_shown(const RenderCommandRequest& request, RenderHooks hooks, const Begin& begin) {
  const RenderPlan& settings = request.render.settings;
  ProgressDisplay own(request.output.quiet, settings.time_limit, settings.target_error);
  ProgressDisplay& display = request.progress ? *request.progress : own;
  catch_interrupts();
  hooks.progress = [&](const Progress& progress) {
    display.show(progress);
    return !interrupted();
  };
  auto result = begin(hooks);
  display.clear();
  return result;
}

// What the pilot of a render learns of lights. One sample of the picture is rendered besides.
LightProbabilities train_light_probabilities(Prepared& prepared) {
  const RenderPlan& settings = prepared.plan.settings;
  if (!trains_light_selection(prepared.packed, settings)) return {};
  RenderPlan one = settings;
  one.sample_total = settings.sample_total > 0 ? settings.sample_total : settings.last_sample; // samplers may ask
  one.last_sample = one.first_sample + 1;
  one.adaptive = kAdaptiveOff;
  const auto rendered = render(*prepared.device, prepared.packed, prepared.view, one, RenderHooks{}, *prepared.kernels,
                               &prepared.on_device);
  return rendered.light_training.probabilities;
}

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

// Renders on all of --devices.
MultiDeviceResult render_on_devices(const RenderCommandRequest& request, Prepared& prepared, RenderHooks hooks,
                                    const std::optional<Picture>& reference, std::vector<TrueError>& true_errors) {
  std::vector<RenderingDevice> devices{{prepared.device.get(), prepared.kernels.get()}};
  for (const OtherDevice& other : prepared.others) devices.push_back({other.device.get(), other.kernels.get()});
  if (reference) hooks.checkpoint = measure_checkpoints(prepared, *reference, true_errors);
  if (prepared.viewer) hooks.show = [&](const Picture& picture) { show(request, prepared, picture); };
  MultiDeviceResult shared = render_shown(request, hooks, [&](const RenderHooks& shown) {
    return render_by_several(devices, prepared.packed, prepared.view, prepared.plan.settings, shown);
  });
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

// Renders, from the state of --checkpoint on where --resume asks for it. `true_errors`: one for each checkpoint that
// this run passes, if there is a reference.
RenderResult render_prepared(const RenderCommandRequest& request, Prepared& prepared, RenderHooks hooks,
                             const std::optional<Picture>& reference, std::vector<TrueError>& true_errors) {
  const StateRequest& state = request.render.state;
  const DeviceInfo& device = prepared.device->info();
  const RenderPlan& settings = prepared.plan.settings;
  const std::optional<RenderState> resumed =
      read_resumed(state, settings, state_identity(prepared), device, prepared.warnings);
  if (resumed && !resumed->levels.empty()) {
    if (request.render.mergeable)
      throw Error(state.file, "has given noisy pixels more samples, so that its picture cannot be merged",
                  "leave out --samples and --mergeable, or begin anew with them");
  }
  if (resumed && request.render.mergeable) {
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
  if (reference) hooks.checkpoint = measure_checkpoints(prepared, *reference, true_errors);
  if (prepared.viewer) hooks.show = [&](const Picture& picture) { show(request, prepared, picture); };
  RenderResult result = render_shown(request, hooks, [&](const RenderHooks& shown) {
    return render(*prepared.device, prepared.packed, prepared.view, settings, shown, *prepared.kernels,
                  &prepared.on_device);
  });
  result.upload_seconds = prepared.on_device.upload_seconds; // by a pilot, perhaps
  return result;
}

} // namespace

int replay(const RenderCommandRequest& request, Prepared& prepared) {
  RenderPlan settings = prepared.plan.settings;
  settings.crop.reset();
  Device& device = *prepared.device;
  settings.training.found = train_light_probabilities(prepared);
  PathReplay replay(device, prepared.packed, prepared.view, settings, *prepared.kernels);
  const PathTrace trace = replay.trace(*request.render.pixel, *request.render.sample, request.render.replicate);
  device.pipeline_cache().save();
  print_warnings(prepared.warnings);
  const nlohmann::ordered_json document = trace_document(trace, prepared.packed, settings);
  print_out("{}", request.output.json ? to_text(document) : trace_text(document));
  return kExitDone;
}

void show(const RenderCommandRequest& request, Prepared& prepared, const Picture& picture) {
  if (!prepared.viewer) return;
  try {
    if (prepared.viewer->show(request.output.pictures.front(), picture)) return;
  } catch (const std::bad_alloc&) { // no room for a copy
  }
  prepared.viewer.reset();
  prepared.warnings.add("--tev: the viewer is gone; the render went on without it");
}

Rendered run(const RenderCommandRequest& request, Prepared& prepared, const std::optional<Picture>& reference,
             const std::function<void(const RenderResult&)>& publish) {
  Rendered rendered;
  std::vector<TrueError> true_errors;
  RenderHooks hooks;
  if (request.output.save_every > 0.0) hooks.publish = publish;
  hooks.publish_interval = request.output.save_every;
  if (!prepared.others.empty()) {
    prepared.on_device = {}; // each device uploads it by itself
    rendered.shared = render_on_devices(request, prepared, hooks, reference, true_errors);
    rendered.result = std::move(rendered.shared->result);
  } else {
    rendered.result = render_prepared(request, prepared, hooks, reference, true_errors);
  }
  rendered.true_errors = align(std::move(true_errors), rendered.result.checkpoints.size());
  return rendered;
}

} // namespace wavepath
