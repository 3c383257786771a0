#include "host/cli/render_run.h"

#include <new>

#include "host/base/output_files.h"
#include "host/base/print.h"
#include "host/cli/commands.h"
#include "host/cli/interrupt.h"
#include "host/cli/plan_report.h"
#include "host/cli/progress.h"
#include "host/cli/trace_report.h"
#include "host/gpu/pipeline_cache.h"
#include "host/render/workspace/light_training.h"

namespace wavepath {
namespace {

bool is_told(const RenderCommandRequest& request, const Decision& decision) {
  const bool asked = decision.what == "integrator" && is_given(request.render, "integrator");
  return !request.output.quiet && (request.output.verbose || decision.is_told || asked);
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

} // namespace

std::unique_ptr<Session> open_session(const RenderCommandRequest& request, SessionUse use) {
  std::unique_ptr<TevViewer> viewer;
  if (!request.output.tev.empty()) viewer = std::make_unique<TevViewer>(request.output.tev);
  auto session = std::make_unique<Session>(
      SessionRequest{.scene = request.scene, .render = request.render, .motion = request.motion, .use = use});
  session->prepared().viewer = std::move(viewer);
  if (!request.render.pixel) refuse_overwriting(targets_of(request), session->scene().files);
  if (!request.output.quiet) print_light(session->loaded());
  return session;
}

void plan_render(const RenderCommandRequest& request, Prepared& prepared) {
  if (const std::string& reference = request.output.reference; !reference.empty() && is_lossy(reference))
    prepared.warnings.add(reference + ": was compressed with a loss, which the true error holds as well");
  plan_render(request.render, prepared);
  for (const Decision& decision : prepared.plan.decisions)
    if (is_told(request, decision)) print_err("wavepath: {}\n", plan_line(decision));
}

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
  const RenderPlan& settings = request.render.settings;
  ProgressDisplay own(request.output.quiet, settings.time_limit, settings.target_error);
  ProgressDisplay& display = request.progress ? *request.progress : own;
  catch_interrupts();
  RunHooks hooks;
  hooks.progress = [&](const Progress& progress) {
    display.show(progress);
    return !interrupted();
  };
  if (prepared.viewer) hooks.show = [&](const Picture& picture) { show(request, prepared, picture); };
  if (request.output.save_every > 0.0) hooks.publish = publish;
  hooks.publish_interval = request.output.save_every;
  if (reference) hooks.reference = &*reference;
  Rendered rendered = run(request.render, prepared, hooks);
  display.clear();
  return rendered;
}

} // namespace wavepath
