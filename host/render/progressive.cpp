#include "host/integrators/path/film_transfer.h"
#include "host/render/progressive.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "host/film/error.h"
#include "host/render/integrator.h"

namespace wavepath {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kLongestWave = 0.03;   // seconds: a window stays responsive
constexpr double kCoarseFrame = 0.1;    // seconds that a picture may take while the camera moves
constexpr std::uint32_t kCoarsest = 8;  // pixels a side
constexpr double kEstimateShare = 0.02; // of the time, that estimating the error may take
constexpr double kFirstEstimate = 1e-7; // seconds a pixel, before one was measured
constexpr std::uint32_t kMostSamples =
    4096; // of a pass: accumulate loops over them, and Mesa 22.3 ends loops at 65,535

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

double pixels_of(const RenderSettings& settings) { return static_cast<double>(settings.width) * settings.height; }

// Every pixel gets the same samples, and nothing but its samples, or the one who looks, ends the render.
RenderSettings open_ended(RenderSettings settings) {
  settings.adaptive = false;
  settings.time_limit = settings.target_error = 0.0;
  return settings;
}

// Any number of light samples that set_settings() may ask for has room.
std::uint32_t lasting_slots(const Device& device, const PackedScene& scene, const RenderSettings& settings) {
  const std::uint32_t slots = choose_slots(device.info(), scene, settings);
  return settings.wave_slots ? slots : std::max(slots, kMostFrameRays);
}

} // namespace

Progressive::Progressive(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
                         KernelCompiler& kernels)
    : device_(device),
      scene_(&scene),
      kernels_(kernels),
      settings_(open_ended(settings)),
      rendered_(settings_),
      view_(view),
      tracer_(std::make_unique<PathTracer>(device, scene, view, settings_, lasting_slots(device, scene, settings_),
                                           kernels)),
      governor_(tracer_->slots(), kLongestWave) {
  begin_anew(choose_coarse());
}

Progressive::~Progressive() = default;

bool Progressive::step() {
  collect_estimate();
  compiling_ = !tracer_->is_ready() || (hybrid_ && !hybrid_->is_ready());
  if (compiling_ || is_done()) return false;
  const Clock::time_point start = Clock::now();
  if (pass_samples_ == 0) begin_pass();
  render_wave();
  const bool whole = band_ == tracer_->bands().size() || tracer_->bands()[band_].pixel_count == 0;
  if (whole && hybrid_) hybrid_->end_frame();
  pass_seconds_ += seconds_since(start);
  if (whole) end_pass();
  return true;
}

// The only place where the film gets samples.
void Progressive::render_wave() {
  const FilmBand& band = tracer_->bands()[band_];
  const std::uint32_t paths = hybrid_ ? hybrid_->samples_per_pixel() : pass_samples_; // of a pixel
  const std::uint32_t count = std::min(std::max(governor_.wave() / paths, 1u), band.pixel_count - pixels_done_);
  const std::uint32_t first = band.first_pixel + pixels_done_;
  const Clock::time_point start = Clock::now();
  if (hybrid_)
    hybrid_->render_wave(band, first, count);
  else
    tracer_->render_wave(band, first, count, sample_, pass_samples_);
  governor_.report(seconds_since(start), count * paths);
  pixels_done_ += count;
  if (pixels_done_ < band.pixel_count) return;
  ++band_;
  pixels_done_ = 0;
}

void Progressive::move(const View& view) {
  if (moving_ && spp() == 0 && pass_samples_ > 0) {
    next_view_ = view;
    return;
  }
  moving_ = true;
  view_ = view;
  begin_anew(choose_coarse());
}

void Progressive::rest() {
  moving_ = false;
  if (is_for_motion() && spp() > 0) begin_anew(1); // else once that picture is complete
}

void Progressive::set_view(const View& view) {
  moving_ = false;
  view_ = view;
  begin_anew(choose_coarse());
}

void Progressive::set_settings(const RenderSettings& settings, const View& view) {
  settings_ = open_ended(settings);
  view_ = view;
  begin_anew(choose_coarse());
}

void Progressive::set_scene(const PackedScene& scene, const View& view) {
  scene_ = &scene;
  view_ = view;
  hybrid_.reset();
  tracer_.reset(); // both scenes at once may be too much
  tracer_ =
      std::make_unique<PathTracer>(device_, scene, view, settings_, lasting_slots(device_, scene, settings_), kernels_);
  governor_ = Governor(tracer_->slots(), kLongestWave);
  begin_anew(choose_coarse());
}

// A picture in full that takes long is preceded by a coarse one, so that there is something to see.
std::uint32_t Progressive::choose_coarse() const {
  std::uint32_t coarse = 1;
  const auto frame = [&] { return pixel_sample_seconds_ * pixels_of(settings_) / (coarse * coarse); };
  while (coarse < kCoarsest && (pixel_sample_seconds_ == 0.0 || frame() > kCoarseFrame)) coarse *= 2;
  return coarse;
}

void Progressive::begin_anew(std::uint32_t coarse) {
  next_view_.reset();
  coarse_ = coarse;
  rendered_ = settings_;
  rendered_.width = (settings_.width + coarse - 1) / coarse;
  rendered_.height = (settings_.height + coarse - 1) / coarse;
  rendered_.antialias_over_time = moving_ && !settings_.integrator->traces_paths;
  tracer_->change(*scene_, view_, rendered_);
  if (rendered_.integrator->traces_paths)
    hybrid_.reset();
  else if (hybrid_)
    hybrid_->change(*scene_, view_, rendered_, moving_ ? Hybrid::Past::keep : Hybrid::Past::forget);
  else
    hybrid_ = std::make_unique<Hybrid>(device_, *tracer_, *scene_, view_, rendered_);
  sample_ = settings_.first_sample;
  seconds_ = estimate_seconds_ = 0.0;
  rays_ = {};
  checkpoints_.clear();
  estimate_is_stale_ = true;
  reset_pass();
}

void Progressive::reset_pass() {
  pass_samples_ = 0;
  pass_seconds_ = 0.0;
  band_ = 0;
  pixels_done_ = 0;
}

// A pass covers every pixel with the same samples: a frame of a hybrid integrator, or as many as fill a wave, but never
// across a power of two.
void Progressive::begin_pass() {
  if (hybrid_) {
    hybrid_->get_ready();
    if (spp() == 0 && !(moving_ && hybrid_->ambient() != glm::vec3(0.0f))) hybrid_->estimate_ambient();
    hybrid_->begin_frame(moving_ ? motion_frames_++ : sample_); // in motion, every frame is another
    pass_samples_ = 1;
    return;
  }
  const std::uint64_t pixels = std::uint64_t{rendered_.width} * rendered_.height;
  const auto fit = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(governor_.wave() / pixels, 1, kMostSamples));
  const std::uint32_t next_checkpoint = settings_.first_sample + std::bit_ceil(spp() + 1);
  pass_samples_ = std::min({fit, next_checkpoint - sample_, settings_.last_sample - sample_});
}

void Progressive::end_pass() {
  pixel_sample_seconds_ = pass_seconds_ / (pixels_of(rendered_) * pass_samples_);
  seconds_ += pass_seconds_;
  sample_ += pass_samples_;
  rays_ = ray_counts(tracer_->counters());
  reset_pass();
  if (next_view_) {
    view_ = *next_view_;
    begin_anew(choose_coarse());
  } else if (is_for_motion() && !moving_) {
    begin_anew(1);
  } else if (!is_for_motion() && (std::has_single_bit(spp()) || is_done())) {
    estimate();
  }
}

// Reads the film and leaves the rest to a thread, unless that would take more than its share of the time; at the end it
// is done in any case.
void Progressive::estimate() {
  const double pixels = pixels_of(settings_);
  const double cost = pixels * (estimate_pixel_seconds_ > 0.0 ? estimate_pixel_seconds_ : kFirstEstimate);
  const bool pays = estimate_seconds_ + cost <= kEstimateShare * seconds_;
  if (spp() < gpu::kReplicates || (!pays && !is_done())) return;
  if (is_done() && estimating_.valid()) estimating_.wait();
  collect_estimate();
  if (estimating_.valid()) return;
  const Clock::time_point start = Clock::now();
  Checkpoint point{spp(), seconds_, 0.0, rays_, {}};
  for (const StageTime& stage : tracer_->stages()) point.gpu_seconds += stage.seconds;
  estimate_is_stale_ = false;
  estimating_ = std::async(std::launch::async, [point, start, film = this->film()]() mutable {
    point.error = estimate_error(film);
    return Estimate{point, seconds_since(start)};
  });
}

void Progressive::collect_estimate() {
  if (!estimating_.valid() || estimating_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  const Estimate estimate = estimating_.get();
  if (estimate_is_stale_) return;
  estimate_pixel_seconds_ = estimate.seconds / pixels_of(settings_);
  estimate_seconds_ += estimate.seconds;
  checkpoints_.push_back(estimate.point);
}

ProgressiveStatus Progressive::status() const {
  ProgressiveStatus status;
  status.compiling = compiling_;
  status.done = is_done();
  status.coarse = coarse_;
  status.spp = spp();
  status.planned = settings_.last_sample - settings_.first_sample;
  status.fraction = static_cast<double>(status.spp) / status.planned;
  status.seconds = seconds_;
  status.frame_seconds = pixel_sample_seconds_ * pixels_of(rendered_);
  status.mrays_per_second = seconds_ > 0.0 ? 1e-6 * static_cast<double>(rays_.total()) / seconds_ : 0.0;
  if (!checkpoints_.empty() && has_estimate(checkpoints_.back().spp, checkpoints_.back().error)) {
    status.error = checkpoints_.back().error;
    status.error_spp = checkpoints_.back().spp;
  }
  status.slope = fit_slope(checkpoints_, Against::seconds);
  status.memory = tracer_->memory();
  if (hybrid_) status.memory.paths += hybrid_->bytes();
  if (hybrid_) status.ambient = hybrid_->ambient();
  return status;
}

double Progressive::seconds_to(double target) const {
  const ProgressiveStatus now = status();
  if (now.error_spp == 0) return std::numeric_limits<double>::infinity();
  const double end = checkpoints_.back().seconds * growth_for(now.error.relative_rms / target, now.slope);
  return std::max(end - seconds_, 0.0);
}

Film Progressive::film() const { return download_film(*tracer_, rendered_.width, rendered_.height); }

Picture Progressive::picture() const { return develop(film(), settings_.aovs, scene_->origin); }

} // namespace wavepath
