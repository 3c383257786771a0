#include "host/session/prepare.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "host/plan/bvh_quality.h"
#include "host/plan/pilot_runner.h"
#include "host/render/lost_light.h"
#include "host/render/report/plan_file.h"
#include "host/render/settings/crop.h"
#include "host/render/settings/identity.h"
#include "host/render/settings/mips.h"
#include "host/render/settings/setting.h"
#include "host/render/settings/shadow_settings.h"
#include "host/render/settings/textures.h"
#include "host/scene/pack/features.h"
#include "host/scene/pack/light_groups.h"
#include "host/scene/pack/plan.h"
#include "host/scene/scene_hash.h"
#include "host/session/resolve.h"

namespace wavepath {
namespace {

bool needs_identity(const RenderRequest& request) { return request.mergeable || !request.state.file.empty(); }

// Decisions that a state or another file keeps, where the command goes on from it.
std::optional<PlanRecord> recorded_plan(const RenderRequest& request) {
  if (request.recorded) return request.recorded;
  std::error_code error;
  if (request.state.resume && std::filesystem::exists(request.state.file, error)) return read_plan(request.state.file);
  return std::nullopt;
}

std::string identity_as(const RenderRequest& request, const Prepared& prepared, const RenderPlan& settings) {
  std::string identity = identity_of(prepared.scene_hash, prepared.view, settings);
  if (const std::optional<glm::dvec3>& origin = request.origin)
    identity += fmt::format(";origin={:a},{:a},{:a}", origin->x, origin->y, origin->z);
  return identity;
}

} // namespace

Prepared open(const SceneRequest& scene, const RenderRequest& render, LoadedScene& loaded, bool stays_open,
              const SessionDevice& device, std::span<const char* const> window_extensions) {
  Prepared prepared;
  OpenScene opened = open_scene(scene, render, window_extensions, stays_open, device);
  prepared.device = std::move(opened.device);
  prepared.kernels = std::move(opened.kernels);
  loaded = std::move(opened.loaded);
  for (const std::string& wanted : render.other_devices) {
    OtherDevice& other = prepared.others.emplace_back();
    other.device = std::make_unique<Device>(wanted);
    other.kernels = std::make_unique<KernelCompiler>(*other.device);
  }
  return prepared;
}

bool pose_others(const SceneRequest& scene, const RenderPlan& settings, const MotionRequest& motion,
                 const PoseScene& pose, const LoadedScene& loaded, Prepared& prepared) {
  MotionPictures& pictures = prepared.motion = {};
  bool is_still = true, poses = false;
  const auto add = [&](const OtherMoment& other, std::optional<OtherPicture>& picture) {
    if (!other.given()) return;
    picture.emplace();
    if (other.at) {
      SceneRequest there = scene;
      there.load.at = *other.at;
      there.load.shutter.reset();
      is_still &= pose(there);
      poses = true;
      picture->pose = pose_of(loaded.scene);
    }
    picture->view =
        resolve_view(loaded.scene, loaded.framing, other_view(scene.view, other), settings.width, settings.height);
  };
  add(motion.next, pictures.next);
  if (poses && !motion.previous.at) is_still &= pose(scene), poses = false;
  add(motion.previous, pictures.previous);
  if (poses) is_still &= pose(scene);
  if (motion.next.at || motion.previous.at) set_pose_here(loaded.scene, pictures);
  return is_still;
}

Packing packing_of(const RenderRequest& render, const Scene& scene, const Prepared& prepared) {
  const RenderPlan& settings = render.settings;
  const DeviceInfo& device = prepared.device->info();
  Packing packing{.direct = direct_of(settings),
                  .quality = render.bvh ? *render.bvh : choose_quality(settings, plan(scene).triangles_stored, device),
                  .eye = render.origin.value_or(prepared.view.position),
                  .near = {prepared.cut_near.value_or(prepared.view.position)},
                  .lights = settings.lights,
                  .mips = wants_mips(settings),
                  .sources = !prepared.motion.here.instances.empty(),
                  .light_groups = settings.light_groups,
                  .samplers = sampler_limits(settings, device)};
  for (const OtherDevice& other : prepared.others)
    packing.samplers = common_limits(packing.samplers, other.device->info());
  return packing;
}

std::uint32_t usual_lights(const PackedScene& scene) {
  return scene.light_tree.empty() ? gpu::kLightsPower : gpu::kLightsTree;
}

bool packs_alike(const Packing& a, const Packing& b) {
  return a.direct == b.direct && a.quality == b.quality && a.eye == b.eye && a.lights == b.lights && a.mips == b.mips &&
         a.sources == b.sources && a.light_groups == b.light_groups && a.samplers == b.samplers;
}

Packing pack_scene(const SceneRequest& request, const RenderRequest& render, LoadedScene& loaded, Prepared& prepared,
                   PackMemory* memory) {
  RenderPlan settings = render.settings;
  const DeviceInfo& device = prepared.device->info();
  Scene& scene = loaded.scene;
  settings.group_names = prepared.group_names = find_group_names(scene, settings.light_groups);
  prepared.view = resolve_view(scene, loaded.framing, request.view, settings.width, settings.height);
  const Packing packing = packing_of(render, scene, prepared);
  // Other factors of materials take no more memory.
  const bool may_grow = !memory || !memory->has_packed || !memory->is_still || memory->other_images ||
                        memory->other_environment || !prepared.memory;
  if (may_grow)
    prepared.memory.emplace(request.path, plan(scene, packing), expected_features(scene, packing.direct), device);
  prepared.memory->require(settings);
  if (needs_identity(render)) prepared.scene_hash = hash_scene(scene);
  prepared.packed = memory ? pack_again(scene, packing, *memory) : pack(scene, packing);
  prepared.warnings = scene.warnings;
  return packing;
}

void plan_render(const RenderRequest& request, Prepared& prepared) {
  PlanRequest asked{.settings = request.settings,
                    .stands_alone = stands_alone(request),
                    .recorded = recorded_plan(request),
                    .training_paths = request.training_paths,
                    .guide_iterations = request.guide_iterations,
                    .fits = [&](const RenderPlan& way) { return prepared.memory->fits(way); }};
  asked.settings.group_names = prepared.group_names;
  asked.settings.moving = prepared.packed.moves(); // else the shutter would cost something
  PilotRunner pilots(*prepared.device, prepared.packed, prepared.view, *prepared.kernels, prepared.on_device);
  prepared.plan = decide(asked, prepared.packed, pilots.device_class(), &pilots);
  if (!request.bvh) prepared.plan.decisions.push_back(decision_of(prepared.packed.bvh_quality));
  if (request.pixel) prepared.plan.settings.looks_for_noise = false; // which decides about no single path
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
