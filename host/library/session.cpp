// Sessions of the interface: settings to requests, pictures to results.
#include "host/library/session_state.h"

#include <limits>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <wavepath/session.h>
#include <glm/glm.hpp>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/gpu/device.h"
#include "host/gpu/pipeline_cache.h"
#include "host/library/guard.h"
#include "host/library/request.h"
#include "host/library/result_state.h"
#include "host/picture/files/picture_io.h"
#include "host/render/report/stats.h"
#include "host/render/settings/settings_table.h"
#include "host/scene/bounds.h"
#include "host/scene/pack/pick.h"
#include "host/session/prepare.h"
#include "host/session/resume.h"

namespace wavepath_v0 {
namespace {

using wavepath::RenderCommandRequest;
using wavepath::SessionPicture;

Stop stop_of(wavepath::StopReason reason) {
  switch (reason) {
    case wavepath::StopReason::samples:
      return Stop::samples;
    case wavepath::StopReason::time:
      return Stop::time;
    case wavepath::StopReason::target_error:
      return Stop::target_error;
    case wavepath::StopReason::interrupted:
      return Stop::interrupted;
    case wavepath::StopReason::device_lost:
      return Stop::device_lost;
  }
  return Stop::samples;
}

// `session`: that made the picture.
wavepath::PictureInfo info_of(const RenderCommandRequest& request, const SessionPicture& picture,
                              wavepath::Session& session) {
  const wavepath::RenderResult& result = picture.result;
  wavepath::PictureInfo info;
  info.spp = result.spp;
  info.seconds = result.seconds;
  info.error = wavepath::estimated_error(result);
  info.seed = picture.settings.seed;
  info.samples = fmt::format("{}:{}", picture.settings.first_sample, picture.settings.first_sample + result.spp);
  info.scene = request.scene.path;
  info.command = request.command_line;
  info.repeat = picture.repeat;
  if (!info.repeat.empty()) info.repeat += wavepath::layout_flags(request.output.write, request.output.pictures);
  info.plan = wavepath::to_line(picture.plan);
  info.filter = wavepath::kFilterNames[picture.settings.filter];
  info.bias = fmt::format("{}", fmt::join(picture.bias, "; "));
  info.view = picture.view;
  if (const auto& shutter = request.scene.load.shutter) info.exposure_seconds = shutter->second - shutter->first;
  if (picture.settings.lens.aperture > 0.0)
    info.focus = picture.settings.lens.focus
                     ? *picture.settings.lens.focus
                     : wavepath::depth_of_middle(session.packed(), picture.view,
                                                 picture.settings.cull != wavepath::gpu::kCullNone);
  if (request.render.mergeable && result.even) {
    info.identity = session.prepared().identity;
    info.device = wavepath::device_text(session.device_info());
    info.origin = session.packed().origin;
    info.film = result.film;
  }
  return info;
}

Result result_of(const RenderCommandRequest& request, SessionPicture&& picture, wavepath::Session& session) {
  auto state = std::make_shared<ResultState>();
  state->info = info_of(request, picture, session);
  state->spp = picture.result.spp;
  state->seconds = picture.result.seconds;
  state->error = wavepath::estimated_error(picture.result);
  state->stop = stop_of(picture.result.stop);
  state->stats = std::move(picture.stats);
  state->repeat = std::move(picture.repeat);
  for (const auto& [text, count] : picture.warnings.counts())
    state->warnings.push_back(count > 1 ? fmt::format("{} ({} times)", text, count) : text);
  state->picture = std::move(picture.result.picture);
  return Result(std::move(state));
}

// The picture so far, which has no report yet.
Result result_so_far(const RenderCommandRequest& request, const wavepath::RenderResult& result) {
  auto state = std::make_shared<ResultState>();
  state->picture = result.picture;
  state->info.command = request.command_line;
  state->info.scene = request.scene.path;
  state->info.spp = state->spp = result.spp;
  state->info.seconds = state->seconds = result.seconds;
  state->info.error = state->error = wavepath::estimated_error(result);
  state->stop = stop_of(result.stop);
  return Result(std::move(state));
}

wavepath::SessionHooks hooks_of(const RenderCommandRequest& request, const Hooks& hooks) {
  wavepath::SessionHooks inner;
  if (hooks.progress)
    inner.progress = [&hooks](const wavepath::Progress& p) {
      return hooks.progress(
          {p.spp_done, p.spp_planned, p.fraction, p.seconds, p.error.relative_rms, p.mrays_per_second});
    };
  if (hooks.picture) {
    inner.publish_interval = hooks.picture_seconds;
    inner.publish = [&](const wavepath::RenderResult& so_far) { hooks.picture(result_so_far(request, so_far)); };
  }
  inner.measures_missing_light = !request.output.stats.empty() || request.output.json || request.output.verbose;
  return inner;
}

// The files that the settings name: output and stats.
void write_files(const RenderCommandRequest& request, const Result& result) {
  const ResultState& state = *result.state();
  for (const std::string& path : request.output.pictures)
    wavepath::write_picture(path, state.picture, state.info, request.output.write);
  if (!request.output.stats.empty()) wavepath::write_file(request.output.stats, state.stats);
}

void check_result(const RenderCommandRequest& request, const Result& result) {
  if (result.stop() != Stop::device_lost) return;
  throw wavepath::DeviceLost(request.scene.path, "lost its device while rendering", "render it again");
}

Result render_with(wavepath::Session& session, const wavepath::LibraryRequest& request, const Hooks& hooks) {
  wavepath::SessionHooks inner = hooks_of(request.command, hooks);
  if (request.reference) inner.reference = &*request.reference;
  inner.command = request.command.command_line;
  const Result result = result_of(request.command, session.render(request.command.render, inner), session);
  write_files(request.command, result);
  check_result(request.command, result);
  return result;
}

std::vector<Named> named(const std::vector<std::string>& names) {
  std::vector<Named> all;
  for (std::size_t i = 0; i < names.size(); ++i) all.push_back({names[i], i});
  return all;
}

// What the resident scene is told to become, where the request differs from what it shows.
void follow(SessionState& state, const wavepath::SceneRequest& wanted, const wavepath::MotionRequest& motion) {
  wavepath::SceneRequest now = state.loaded;
  now.load.at = wanted.load.at;
  now.load.shutter = wanted.load.shutter;
  now.load.variant = wanted.load.variant;
  now.environment = wanted.environment;
  now.environment_intensity = wanted.environment_intensity;
  now.environment_degrees = wanted.environment_degrees;
  if (wavepath::flags_of(now) != wavepath::flags_of(wanted))
    throw wavepath::UsageError("settings",
                               fmt::format("ask for another scene ({} instead of {})", wavepath::flags_of(wanted),
                                           wavepath::flags_of(state.loaded)),
                               "make another scene with them");
  wavepath::Session& session = *state.session;
  if (wanted.load.at != state.loaded.load.at || wanted.load.shutter != state.loaded.load.shutter)
    session.set_moment(wanted.load.at, wanted.load.shutter);
  session.set_variant(wanted.load.variant);
  if (wanted.environment != state.loaded.environment ||
      wanted.environment_intensity != state.loaded.environment_intensity ||
      wanted.environment_degrees != state.loaded.environment_degrees)
    session.set_environment({wanted.environment, wanted.environment_intensity, wanted.environment_degrees});
  session.set_view(wanted.view);
  if (wavepath::flags_of(motion) != wavepath::flags_of(state.motion)) session.set_motion(motion);
  state.loaded = wanted;
  state.motion = motion;
}

} // namespace

SessionState::~SessionState() {
  // A callback of a render may have dropped it: then this thread has the device, and what others use stays as it is.
  std::optional<DeviceLock> lock;
  if (device && device->user != std::this_thread::get_id()) lock.emplace(*device);
  session.reset();
}

Session::Session(const Scene& scene, const Settings& settings, const std::optional<Device>& device)
    : state_(wavepath::guarded([&] {
        auto state = wavepath::make_kept_over_fork<SessionState>();
        state->scene = scene;
        state->settings = settings;
        const wavepath::LibraryRequest request = wavepath::read_request(scene, settings);
        wavepath::SessionRequest wanted{
            .scene = request.command.scene, .render = request.command.render, .motion = request.command.motion};
        std::optional<DeviceLock> lock;
        if (device) {
          state->device = device->state();
          wanted.device = state->device->device;
          lock.emplace(*state->device);
        }
        state->session = std::make_unique<wavepath::Session>(wanted);
        if (!state->device) state->device = keep_device(state->session->device());
        state->loaded = wanted.scene;
        state->motion = wanted.motion;
        return state;
      })) {}

std::vector<Named> Session::cameras() const {
  std::vector<std::string> names;
  for (const wavepath::Camera& camera : state_->session->scene().cameras) names.push_back(camera.name);
  return named(names);
}

std::vector<std::string> Session::variants() const { return state_->session->scene().variants; }

std::vector<Named> Session::nodes() const { return named(state_->session->scene().node_names); }

std::vector<Named> Session::materials() const {
  std::vector<std::string> names;
  for (const wavepath::Material& material : state_->session->scene().materials) names.push_back(material.name);
  return named(names);
}

std::array<Point, 2> Session::bounds() const {
  return wavepath::guarded([&] {
    const DeviceLock lock(*state_->device);
    const wavepath::Scene& scene = state_->session->scene();
    constexpr double kFar = std::numeric_limits<double>::infinity();
    glm::dvec3 low(kFar), high(-kFar);
    for (const wavepath::Instance& instance : scene.instances)
      for (const glm::vec3& position : scene.meshes[instance.mesh].positions) {
        const glm::dvec3 point = instance.world_from_object * glm::dvec4(position, 1.0);
        low = glm::min(low, point), high = glm::max(high, point);
      }
    if (scene.volume) {
      const wavepath::Bounds box = wavepath::volume_bounds(*scene.volume);
      low = glm::min(low, box.lo), high = glm::max(high, box.hi);
    }
    return std::array<Point, 2>{{{low.x, low.y, low.z}, {high.x, high.y, high.z}}};
  });
}

Device Session::device() const { return Device(state_->device); }

Result Session::render(const Settings& settings, const Hooks& hooks) {
  return wavepath::guarded([&] {
    const DeviceLock lock(*state_->device);
    const wavepath::LibraryRequest request =
        wavepath::read_request(state_->scene, Settings(state_->settings).add(settings));
    follow(*state_, request.command.scene, request.command.motion);
    const Result result = render_with(*state_->session, request, hooks);
    state_->edited.clear();
    if (!std::exchange(state_->keeps_kernels, true)) state_->device->device.device->pipeline_cache().save();
    return result;
  });
}

Result Session::render(const Camera& camera, const Settings& settings, const Hooks& hooks) {
  return render(camera.settings().add(settings), hooks);
}

Result render(const Scene& scene, const Settings& settings, const Hooks& hooks) {
  return wavepath::guarded([&] {
    const wavepath::LibraryRequest request = wavepath::read_request(scene, settings);
    wavepath::Session session({.scene = request.command.scene,
                               .render = request.command.render,
                               .motion = request.command.motion,
                               .use = wavepath::SessionUse::one_picture});
    return render_with(session, request, hooks);
  });
}

} // namespace wavepath_v0
