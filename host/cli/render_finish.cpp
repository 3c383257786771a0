#include "host/cli/render_finish.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/base/atomic_file.h"
#include "host/base/clock.h"
#include "host/base/error.h"
#include "host/base/print.h"
#include "host/base/process_clock.h"
#include "host/cli/commands.h"
#include "host/cli/interrupt.h"
#include "host/cli/report.h"
#include "host/gpu/pipeline_cache.h"
#include "host/render/denoised.h"
#include "host/render/report/diagnosis.h"
#include "host/render/settings/pass_names.h"
#include "host/render/settings/settings_table.h"
#include "host/scene/pack/pick.h"
#include "host/session/finish.h"
#include "host/session/repeat.h"
#include "host/session/resume.h"

namespace wavepath {
namespace {

PictureInfo picture_info(const RenderCommandRequest& request, const Prepared& prepared, const Rendered& rendered,
                         const Run& run) {
  const RenderPlan& settings = prepared.plan.settings;
  const RenderResult& result = rendered.result;
  PictureInfo info;
  info.spp = result.spp;
  info.seconds = result.seconds;
  info.error = estimated_error(result);
  info.seed = settings.seed;
  info.samples = fmt::format("{}:{}", settings.first_sample, settings.first_sample + result.spp);
  info.scene = request.scene.path;
  info.command = request.command_line;
  info.repeat = run.repeat;
  info.plan = to_line(run.plan);
  info.filter = kFilterNames[settings.filter];
  info.bias = fmt::format("{}", fmt::join(run.bias, "; "));
  info.view = prepared.view;
  if (request.frame && request.frame->fps > 0.0)
    info.frame = SequenceFrame{static_cast<int>(request.frame->number), request.frame->fps};
  if (settings.lens.aperture > 0.0)
    info.focus = settings.lens.focus ? *settings.lens.focus
                                     : depth_of_middle(prepared.packed, prepared.view, settings.cull != gpu::kCullNone);
  if (const auto& shutter = request.scene.load.shutter) info.exposure_seconds = shutter->second - shutter->first;
  if (request.render.mergeable && result.even) {
    info.identity = prepared.identity;
    info.device = device_text(prepared.device->info());
    if (rendered.shared && !rendered.shared->bits_agree) info.device = "several devices that round differently";
    info.origin = prepared.packed.origin;
    info.film = result.film;
  }
  return info;
}

int exit_code(const RenderCommandRequest& request, const RenderResult& result) {
  if (result.stop == StopReason::interrupted) return kExitInterrupted;
  const double target = request.render.settings.target_error;
  const std::optional<double> error = estimated_error(result);
  return target > 0.0 && !(error && *error <= target) ? kExitTargetMissed : kExitDone;
}

bool reports_bias(const RenderCommandRequest& request) {
  return !request.output.stats.empty() || request.output.json || request.output.verbose;
}

// An interrupt that comes meanwhile ends passes. One that has ended the render does not, since they take little beside
// it; nor in a film, where a picture without them would be taken for the frame.
void add_passes(const RenderCommandRequest& request, Prepared& prepared, RenderResult& result,
                const MultiDeviceResult* shared) {
  const bool goes_on = interrupted() || request.frame.has_value();
  add_passes_if_asked(prepared, result, shared, [=] { return goes_on || !interrupted(); });
}

// What a report tells without measuring more.
Run run_of(const RenderCommandRequest& request, const Prepared& prepared, const RenderPlan& settings,
           const RenderResult& result) {
  Run run{request.scene.path, request.command_line, prepared.device->info(), settings, prepared.packed, result};
  run.plan = prepared.plan.decisions;
  add_outcomes(run.plan, result);
  run.repeat = repeat_command(request.scene, request.render, request.motion, prepared, result);
  if (!run.repeat.empty()) run.repeat += layout_flags(request.output.write, request.output.pictures);
  run.frame = request.frame;
  run.view = &prepared.view;
  run.load_seconds = prepared.load_seconds;
  return run;
}

// The picture is written; what else is wrong ends the command.
void check_result(const RenderCommandRequest& request, const DeviceInfo& device, const RenderPlan& settings,
                  const RenderResult& result) {
  if (request.render.strict && result.nonfinite.first)
    throw Error(request.scene.path,
                fmt::format("samples that were not finite: {}, {}", result.nonfinite.samples(),
                            describe_first(result.nonfinite, settings)),
                "report this with the scene, or render without --strict");
  if (result.stop == StopReason::device_lost)
    throw DeviceLost(
        device.name,
        fmt::format("was lost while rendering; what is written has the first {} samples a pixel", result.spp),
        request.render.state.file.empty() ? "render with --checkpoint to go on after such an end"
        : request.render.state.resume     ? "run the same command to go on"
                                          : "add --resume to go on");
}

} // namespace

void save_so_far(const RenderCommandRequest& request, Prepared& prepared, const RenderResult& so_far) {
  const auto try_to = [&](const auto& step) {
    try {
      step();
    } catch (const std::exception& failure) {
      prepared.warnings.add(fmt::format("--save-every: {} (the render went on)", failure_text(failure)));
    }
  };
  Rendered rendered{.result = so_far, .shared = {}, .true_errors = {}};
  if (!prepared.others.empty()) rendered.result.even = false; // whether the devices round alike is known at the end
  try_to([&] { denoise_if_asked(rendered.result, prepared.plan.settings); });
  Run run = run_of(request, prepared, prepared.plan.settings, rendered.result);
  run.bias = list_bias(prepared.plan.settings, prepared.packed, rendered.result);
  run.peak_bytes = prepared.device->memory_peak();
  run.kernel_cache = prepared.device->pipeline_cache().describe();
  const PictureInfo info = picture_info(request, prepared, rendered, run);
  for (const std::string& path : request.output.pictures)
    try_to([&] { write_picture(path, rendered.result.picture, info, request.output.write); });
  run.total_seconds = seconds_since_process_start();
  if (request.output.stats.empty()) return;
  try_to([&] {
    nlohmann::ordered_json document = stats_document(run);
    document["under_way"] = true;
    write_file(request.output.stats, to_text(document));
  });
}

std::unique_ptr<Unwritten> end_render(const RenderCommandRequest& request, Prepared& prepared, Rendered& rendered,
                                      const std::optional<Picture>& reference) {
  auto ended = std::make_unique<Unwritten>(Unwritten{request, prepared.plan.settings, std::move(rendered)});
  const RenderPlan& settings = ended->settings;
  RenderResult& result = ended->rendered.result;
  const MultiDeviceResult* shared = ended->rendered.shared ? &*ended->rendered.shared : nullptr;
  ended->attempts.attempt([&] { denoise_if_asked(result, settings); });
  const Clock::time_point passes_start = Clock::now();
  add_passes(request, prepared, result, shared);
  const double pass_seconds = seconds_since(passes_start);
  show(request, prepared, result.picture);
  Run& run = ended->run.emplace(run_of(request, prepared, settings, result));
  if (std::ranges::any_of(settings.aovs, is_pass)) run.pass_seconds = pass_seconds;
  run.shared = shared;
  MissingLight missing;
  if (reports_bias(request)) missing = measure_missing_light(prepared, result, shared, [] { return !interrupted(); });
  run.bias = list_bias(settings, prepared.packed, result, missing);
  if (reference && result.denoised)
    why_not_measured(prepared, "the true error of the filtered picture was",
                     [&] { run.denoised_error = measure_true_error(shown_picture(result.picture), *reference); });
  run.true_errors = ended->rendered.true_errors;
  run.diagnosis = diagnose(settings, prepared.packed, result, run.true_errors, run.bias);
  if (request.render.mergeable && !result.even)
    prepared.warnings.add("stopped before all pixels had the same samples, so the picture cannot be merged");
  Device& device = *prepared.device;
  run.peak_bytes = device.memory_peak();
  if (device.memory_displaced() > 0)
    prepared.warnings.add(fmt::format("the device's memory is full: {:.1f} MiB lie elsewhere, which is much slower",
                                      static_cast<double>(device.memory_displaced()) / 1048576.0));
  device.pipeline_cache().save();
  run.kernel_cache = device.pipeline_cache().describe();
  ended->info = picture_info(request, prepared, ended->rendered, run);
  if (!request.output.stats.empty() || request.output.json)
    ended->attempts.attempt([&] { ended->document = stats_document(run); });
  ended->warnings = prepared.warnings;
  return ended;
}

void write(Unwritten& render) {
  const Clock::time_point start = Clock::now();
  OutputRequest& output = render.request.output;
  write_pictures(output, render.info, render.rendered.result.picture, render.warnings, render.attempts);
  Run& run = *render.run;
  run.write_seconds = seconds_since(start);
  run.total_seconds = seconds_since_process_start();
  if (render.document.is_null()) return;
  render.attempts.attempt([&] {
    set_last_seconds(run, render.document);
    render.text = to_text(render.document);
  });
  if (!output.stats.empty() && !render.text.empty())
    render.attempts.attempt([&] { write_file(output.stats, render.text); });
}

int tell(Unwritten& render) {
  const RenderResult& result = render.rendered.result;
  report(*render.run, render.request.output, render.warnings, render.text, render.attempts);
  render.attempts.finish();
  check_result(render.request, render.run->device, render.settings, result);
  return exit_code(render.request, result);
}

int finish(const RenderCommandRequest& request, Prepared& prepared, Rendered& rendered,
           const std::optional<Picture>& reference) {
  const std::unique_ptr<Unwritten> ended = end_render(request, prepared, rendered, reference);
  write(*ended);
  const auto wait_for_viewer = [&] { // all else is done, so that it costs a second at most
    if (prepared.viewer && !prepared.viewer->finish())
      print_err("wavepath: warning: --tev: the viewer did not take the whole picture\n");
  };
  try {
    const int code = tell(*ended);
    wait_for_viewer();
    return code;
  } catch (...) {
    wait_for_viewer();
    throw;
  }
}

} // namespace wavepath
