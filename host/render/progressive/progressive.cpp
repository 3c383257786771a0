#include "host/render/progressive/progressive.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/film/error.h"
#include "host/render/settings/probing.h"

namespace wavepath {
namespace {

constexpr double kLongestWave = 0.015;         // seconds: with two in flight, a window stays responsive
constexpr std::uint32_t kCoarsest = 8;         // pixels a side
constexpr std::uint32_t kMostSlots = 1u << 21; // more paths take no GPU so little time

double pixels_of(const RenderPlan& settings) { return static_cast<double>(settings.width) * settings.height; }

// Every pixel gets the same samples, and nothing but its samples, or the user, ends the render.
RenderPlan open_ended(RenderPlan settings) {
  settings.adaptive = kAdaptiveOff;
  settings.time_limit = settings.target_error = 0.0;
  // Coarse pictures are too small for error probes, and are rendered by the kernels of the fine ones.
  settings.kernels.has_probes = has_error_probes(settings);
  settings.kernels.mips = true; // for frames in motion
  return settings;
}

LoopPolicy policy_of(const RenderPlan& settings) {
  return {.longest_dispatch = kLongestWave,
          .by_wave = true,
          .estimates = Estimates::cheap,
          .clock_is_busy_time = true,
          .least_slots = settings.wave_slots ? 0 : kMostFrameRays,
          .most_slots = settings.wave_slots ? ~0u : kMostSlots};
}

} // namespace

Progressive::Progressive(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                         KernelCompiler& kernels, std::shared_ptr<const DeviceScene> uploaded)
    : device_(device),
      scene_(&scene),
      kernels_(kernels),
      settings_(open_ended(settings)),
      rendered_(settings_),
      view_(view) {
  make_loop(std::move(uploaded));
  begin_anew(choose_coarse());
}

std::unique_ptr<Progressive> Progressive::beside(const RenderPlan& settings) const {
  return std::make_unique<Progressive>(device_, *scene_, view_, settings, kernels_, loop_->workspace().on_device);
}

void Progressive::make_loop(std::shared_ptr<const DeviceScene> uploaded) {
  loop_.reset(); // the device may not hold both scenes at once
  loop_ = std::make_unique<RenderLoop>(device_, *scene_, view_, settings_, kernels_, RenderHooks{},
                                       policy_of(settings_), std::move(uploaded));
}

bool Progressive::step() {
  loop_->collect_estimates(false);
  compiling_ = !loop_->is_ready();
  if (compiling_ || !loop_->step()) return false;
  if (!loop_->in_pass()) end_pass();
  return true;
}

void Progressive::end_pass() {
  if (next_view_) {
    view_ = *next_view_;
    begin_anew(choose_coarse());
  } else if (is_for_motion() && !moving_) {
    begin_anew(1);
  } else if (loop_->is_done()) {
    loop_->drain(); // no later step() would wait for them
  }
}

void Progressive::move(const View& view) {
  if (moving_ && loop_->spp() == 0 && loop_->in_pass()) {
    next_view_ = view;
    return;
  }
  moving_ = true;
  view_ = view;
  begin_anew(choose_coarse());
}

void Progressive::rest() {
  moving_ = false;
  if (is_for_motion() && loop_->spp() > 0) begin_anew(1); // else once that picture is complete
}

void Progressive::set_view(const View& view) {
  moving_ = false;
  view_ = view;
  begin_anew(choose_coarse());
}

void Progressive::set_settings(const RenderPlan& settings, const View& view) {
  settings_ = open_ended(settings);
  view_ = view;
  begin_anew(choose_coarse());
}

void Progressive::set_scene(const PackedScene& scene, const View& view, const RenderPlan& settings,
                            std::shared_ptr<const DeviceScene> uploaded) {
  scene_ = &scene;
  settings_ = open_ended(settings);
  view_ = view;
  make_loop(std::move(uploaded));
  begin_anew(choose_coarse());
}

// Where a full picture takes long, a coarse one precedes it, so that the window shows a picture early.
std::uint32_t Progressive::choose_coarse() const {
  std::uint32_t coarse = 1;
  loop_->drain(); // so that the last pass counts
  const double pixel_seconds = loop_->pixel_seconds();
  const auto frame = [&] { return pixel_seconds * pixels_of(settings_) / (coarse * coarse); };
  while (coarse < kCoarsest && (pixel_seconds == 0.0 || frame() > coarse_seconds_)) coarse *= 2;
  return coarse;
}

void Progressive::begin_anew(std::uint32_t coarse) {
  const bool in_motion = moving_ && !settings_.integrator->traces_paths;
  if (rendered_.antialias_over_time) motion_frames_ = rendered_.first_sample + loop_->spp();
  next_view_.reset();
  coarse_ = coarse;
  rendered_ = settings_;
  rendered_.width = (settings_.width + coarse - 1) / coarse;
  rendered_.height = (settings_.height + coarse - 1) / coarse;
  rendered_.antialias_over_time = in_motion;
  if (in_motion) { // every frame has another view
    rendered_.first_sample += motion_frames_;
    rendered_.last_sample += motion_frames_;
    if (rendered_.sample_total == 0) rendered_.sample_total = settings_.last_sample;
  }
  loop_->restart(view_, rendered_, moving_ ? TemporalHistory::keep : TemporalHistory::forget);
}

ProgressiveStatus Progressive::status() const {
  ProgressiveStatus status;
  status.compiling = compiling_;
  status.done = is_done();
  status.coarse = coarse_;
  status.spp = loop_->spp();
  status.planned = settings_.last_sample - settings_.first_sample;
  status.fraction = static_cast<double>(status.spp) / status.planned;
  status.seconds = loop_->seconds();
  status.frame_seconds = loop_->pixel_seconds() * pixels_of(rendered_);
  const double rays = static_cast<double>(loop_->totals().rays.total());
  status.mrays_per_second = status.seconds > 0.0 ? 1e-6 * rays / status.seconds : 0.0;
  const std::vector<Checkpoint>& checkpoints = loop_->checkpoints();
  if (!checkpoints.empty() && has_estimate(checkpoints.back().spp, checkpoints.back().error)) {
    status.error = checkpoints.back().error;
    status.error_spp = checkpoints.back().spp;
  }
  status.slope = fit_slope(checkpoints, Against::seconds);
  status.memory = loop_->memory();
  RenderResult result;
  loop_->integrator().describe(result);
  status.ambient = result.ambient;
  status.shadows = std::move(result.shadows);
  return status;
}

double Progressive::seconds_to(double target) const {
  const ProgressiveStatus now = status();
  if (now.error_spp == 0) return std::numeric_limits<double>::infinity();
  const double end = loop_->checkpoints().back().seconds * growth_for(now.error.relative_rms / target, now.slope);
  return std::max(end - now.seconds, 0.0);
}

Picture Progressive::picture() { return develop(film(), settings_.aovs, scene_->origin, settings_.group_names); }

} // namespace wavepath
