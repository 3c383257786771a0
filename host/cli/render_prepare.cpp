#include "host/cli/render_prepare.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "host/base/clock.h"
#include "host/base/output_files.h"
#include "host/base/print.h"
#include "host/cli/open_scene.h"
#include "host/cli/plan_report.h"
#include "host/cli/resolve.h"
#include "host/plan/bvh_quality.h"
#include "host/plan/pilot_runner.h"
#include "host/render/lost_light.h"
#include "host/render/report/plan_file.h"
#include "host/render/settings/crop.h"
#include "host/render/settings/identity.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/mips.h"
#include "host/render/settings/shadow_settings.h"
#include "host/render/settings/textures.h"
#include "host/scene/pack/features.h"
#include "host/scene/pack/light_groups.h"
#include "host/scene/pack/plan.h"
#include "host/scene/scene_hash.h"

namespace wavepath {
namespace {

bool needs_identity(const RenderCommandRequest& request) {
  return request.render.mergeable || !request.render.state.file.empty();
}

// Decisions that a state or another file keeps, where the command goes on from it.
std::optional<PlanRecord> recorded_plan(const RenderCommandRequest& request) {
  if (request.recorded) return request.recorded;
  const RenderRequest& render = request.render;
  std::error_code error;
  if (render.state.resume && std::filesystem::exists(render.state.file, error)) return read_plan(render.state.file);
  return std::nullopt;
}

std::string identity_as(const RenderCommandRequest& request, const Prepared& prepared, const RenderPlan& settings) {
  std::string identity = identity_of(prepared.scene_hash, prepared.view, settings);
  if (const std::optional<glm::dvec3>& origin = request.render.origin)
    identity += fmt::format(";origin={:a},{:a},{:a}", origin->x, origin->y, origin->z);
  return identity;
}

bool is_told(const RenderCommandRequest& request, const Decision& decision) {
  const bool asked = decision.what == "integrator" && is_given(request.render, "integrator");
  return !request.output.quiet && (request.output.verbose || decision.is_told || asked);
}

} // namespace

Prepared prepare(const RenderCommandRequest& request) {
  const Clock::time_point start = Clock::now();
  LoadedScene loaded; // which is freed here: rendering needs the packed one
  const bool poses_others = request.motion.next.at || request.motion.previous.at;
  Prepared prepared = open(request, loaded, poses_others);
  pose_others(request, loaded, prepared);
  loaded.file.reset();
  pack_scene(request, loaded, prepared);
  prepared.load_seconds = seconds_since(start) - prepared.packed.bvh_seconds;
  return prepared;
}

Prepared open(const RenderCommandRequest& request, LoadedScene& loaded, bool stays_open) {
  Prepared prepared;
  if (!request.output.tev.empty()) prepared.viewer = std::make_unique<TevViewer>(request.output.tev);
  OpenScene opened = open_scene(request.scene, request.render, {}, stays_open);
  prepared.device = std::move(opened.device);
  prepared.kernels = std::move(opened.kernels);
  loaded = std::move(opened.loaded);
  for (const std::string& wanted : request.render.other_devices) {
    OtherDevice& other = prepared.others.emplace_back();
    other.device = std::make_unique<Device>(wanted);
    other.kernels = std::make_unique<KernelCompiler>(*other.device);
  }
  if (!request.render.pixel) refuse_overwriting(targets_of(request), loaded.scene.files);
  if (!request.output.quiet) print_light(loaded);
  return prepared;
}

bool pose_others(const RenderCommandRequest& request, LoadedScene& loaded, Prepared& prepared) {
  const RenderPlan& settings = request.render.settings;
  MotionPictures& pictures = prepared.motion = {};
  bool is_still = true, poses = false;
  const auto add = [&](const OtherMoment& other, std::optional<OtherPicture>& picture) {
    if (!other.given()) return;
    picture.emplace();
    if (other.at) {
      SceneRequest there = request.scene;
      there.load.at = *other.at;
      there.load.shutter.reset();
      is_still &= pose_again(there, loaded);
      poses = true;
      picture->pose = pose_of(loaded.scene);
    }
    picture->view = resolve_view(loaded.scene, loaded.framing, other_view(request.scene.view, other), settings.width,
                                 settings.height);
  };
  add(request.motion.next, pictures.next);
  if (poses && !request.motion.previous.at) is_still &= pose_again(request.scene, loaded), poses = false;
  add(request.motion.previous, pictures.previous);
  if (poses) is_still &= pose_again(request.scene, loaded);
  if (request.motion.next.at || request.motion.previous.at) set_pose_here(loaded.scene, pictures);
  return is_still;
}

void pack_scene(const RenderCommandRequest& request, LoadedScene& loaded, Prepared& prepared, PackMemory* memory) {
  RenderPlan settings = request.render.settings;
  const DeviceInfo& device = prepared.device->info();
  Scene& scene = loaded.scene;
  settings.group_names = prepared.group_names = find_group_names(scene, settings.light_groups);
  const View view = resolve_view(scene, loaded.framing, request.scene.view, settings.width, settings.height);
  const bvh::Quality quality =
      request.render.bvh.value_or(choose_quality(settings, plan(scene).triangles_stored, device));
  Packing packing{.direct = direct_of(settings),
                  .quality = quality,
                  .eye = request.render.origin.value_or(view.position),
                  .near = {view.position},
                  .lights = settings.lights,
                  .mips = wants_mips(settings),
                  .sources = !prepared.motion.here.instances.empty(),
                  .light_groups = settings.light_groups,
                  .samplers = sampler_limits(settings, device)};
  for (const OtherDevice& other : prepared.others)
    packing.samplers = common_limits(packing.samplers, other.device->info());
  prepared.memory.emplace(request.scene.path, plan(scene, packing), expected_features(scene, packing.direct), device);
  prepared.memory->require(settings);
  if (needs_identity(request)) prepared.scene_hash = hash_scene(scene);
  prepared.view = view;
  prepared.packed = memory ? pack_again(scene, packing, *memory) : pack(scene, packing);
  prepared.warnings = scene.warnings;
  if (const std::string& reference = request.output.reference; !reference.empty() && is_lossy(reference))
    prepared.warnings.add(reference + ": was compressed with a loss, which the true error holds as well");
}

void plan_render(const RenderCommandRequest& request, Prepared& prepared) {
  PlanRequest asked{.settings = request.render.settings,
                    .stands_alone = stands_alone(request.render),
                    .recorded = recorded_plan(request),
                    .training_paths = request.render.training_paths,
                    .guide_iterations = request.render.guide_iterations,
                    .fits = [&](const RenderPlan& way) { return prepared.memory->fits(way); }};
  asked.settings.group_names = prepared.group_names;
  asked.settings.moving = prepared.packed.moves(); // else the shutter would cost something
  PilotRunner pilots(*prepared.device, prepared.packed, prepared.view, *prepared.kernels, prepared.on_device);
  prepared.plan = decide(asked, prepared.packed, pilots.device_class(), &pilots);
  if (!request.render.bvh) prepared.plan.decisions.push_back(decision_of(prepared.packed.bvh_quality));
  if (request.render.pixel) prepared.plan.settings.looks_for_noise = false; // which decides about no single path
  for (const Decision& decision : prepared.plan.decisions)
    if (is_told(request, decision)) print_err("wavepath: {}\n", plan_line(decision));
  for (const std::string& warning : prepared.plan.warnings) prepared.warnings.add(warning);
  if (prepared.plan.settings.crop && !renders_part(prepared.plan.settings))
    prepared.warnings.add(
        fmt::format("--crop: --integrator {} renders the whole picture and keeps the part, so that "
                    "parts save no work; split it by --samples",
                    name_of(prepared.plan.settings.integrator)));
  if (const std::string unlit = unlit_bodies(prepared.packed); !unlit.empty()) prepared.warnings.add(unlit);
  prepared.memory->require(prepared.plan.settings); // which a state may have told, or pilots made to take more
  if (needs_identity(request)) prepared.identity = identity_as(request, prepared, prepared.plan.settings);
}

} // namespace wavepath
