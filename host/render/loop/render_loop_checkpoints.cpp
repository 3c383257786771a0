// Checkpoints of the render loop: estimates of the error beside the next waves, the target, states to resume from, and
// the result.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "host/base/clock.h"
#include "host/film/error.h"
#include "host/render/loop/adaptive.h"
#include "host/render/loop/render_loop.h"

namespace wavepath {
namespace {

// Estimates in progress at once: each holds a copy of the film.
constexpr std::size_t kMostPending = 2;
constexpr double kEstimateShare = 0.02; // of the time, where estimates may be skipped
constexpr double kFirstEstimate = 1e-7; // seconds a pixel, before one was measured
// Few samples a pixel may have missed rare light, so no estimate of fewer ends a render.
constexpr std::uint32_t kFewestSamples = 16;
constexpr double kShortestStep = 1.0 / 16; // from one estimate of the error to the next; each costs time

double gpu_seconds(const Totals& totals) {
  double sum = 0.0;
  for (const StageTime& stage : totals.stages) sum += stage.seconds;
  return sum;
}

ErrorEstimate unknown_error() {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  return {kUnknown, {kUnknown, kUnknown}, 0.0};
}

// Samples from one estimate of the error to the next, such that all replicates have as many.
std::uint32_t look_step(double samples, bool adaptive) {
  const std::uint32_t multiple = adaptive ? kAdaptiveStep : gpu::kReplicates;
  return (static_cast<std::uint32_t>(samples) / multiple + 1) * multiple;
}

} // namespace

bool RenderLoop::is_checkpoint() const { return std::has_single_bit(spp()) || cursor_.sample == settings_.last_sample; }

// Where estimates may be skipped: coarse pictures in a window, and those that would take more than their share.
bool RenderLoop::pays() const {
  if (pace_.estimates != Estimates::share) return pace_.estimates == Estimates::all;
  if (settings_.antialias_over_time || spp() < gpu::kReplicates) return false;
  if (cursor_.sample == settings_.last_sample) return true;
  const double cost =
      static_cast<double>(pixels()) * (estimate_pixel_seconds_ > 0.0 ? estimate_pixel_seconds_ : kFirstEstimate);
  return pending_.empty() && result_.estimate_seconds + cost <= kEstimateShare * seconds();
}

// Has the device copy the film, and its error estimated beside the next waves.
void RenderLoop::checkpoint() {
  if (!pays()) return;
  while (pending_.size() >= kMostPending) take_in_first();
  if (stopped_) return;
  Pending& pending = pending_.emplace_back();
  pending.sample = cursor_.sample;
  pending.is_checkpoint = is_checkpoint();
  pending.point.spp = samples_per_pixel();
  if (settings_.target_error > 0.0 && pending.point.spp >= kFewestSamples)
    next_check_ = 0, aim_sample_ = cursor_.sample,
    aim_limit_ = std::min(cursor_.sample + look_step(spp() * kShortestStep, settings_.adaptive), settings_.last_sample);
  if (spp() < gpu::kReplicates && !hooks_.checkpoint) { // of fewer samples there is no estimate
    queue_.afterwards([this, &pending] { measure(pending); });
    return;
  }
  if (snapshots_.empty()) snapshots_.push_back(std::make_shared<FilmSnapshot>());
  pending.snapshot = snapshots_.back();
  snapshots_.pop_back();
  pending.snapshot->fit(workspace_.device, workspace_.film);
  queue_.submit([&](Commands& commands) { pending.snapshot->record(commands, workspace_.film); },
                {.done = [this, &pending](const Finished&) { measure(pending); }});
}

// The device has reached the checkpoint: notes time and counts, and begins the estimate.
void RenderLoop::measure(Pending& pending) {
  if (abandoning_) return;
  pending.totals = queue_.totals;
  pending.point.seconds = seconds();
  pending.point.gpu_seconds = gpu_seconds(queue_.totals);
  pending.point.rays = queue_.totals.rays;
  pending.point.error = unknown_error();
  pending.measured = true;
  if (!pending.snapshot) return;
  pending.estimate = std::async(std::launch::async, [snapshot = pending.snapshot] {
    const auto start = Clock::now();
    Estimate estimate;
    estimate.film = std::make_shared<const Film>(snapshot->read());
    estimate.error = estimate_error(*estimate.film);
    estimate.seconds = seconds_since(start);
    return estimate;
  });
}

void RenderLoop::collect_estimates(bool wait) {
  while (!pending_.empty()) {
    const Pending& first = pending_.front();
    const bool ready = first.measured && (!first.estimate.valid() || first.estimate.wait_for(std::chrono::seconds(0)) ==
                                                                         std::future_status::ready);
    if (!ready && !wait) return;
    take_in_first();
  }
}

// The oldest checkpoint becomes part of the result, as soon as its estimate is there.
void RenderLoop::take_in_first() {
  while (!pending_.front().measured && queue_.finish_one()) {
  }
  Pending pending = std::move(pending_.front());
  pending_.pop_front();
  Checkpoint& point = pending.point;
  if (pending.estimate.valid()) {
    Estimate estimate = pending.estimate.get();
    point.error = estimate.error;
    film_ = std::move(estimate.film);
    film_sample_ = pending.sample;
    estimate_pixel_seconds_ = estimate.seconds / static_cast<double>(pixels());
    result_.estimate_seconds += estimate.seconds;
    snapshots_.push_back(std::move(pending.snapshot));
  }
  last_ = point;
  result_.error = point.error;
  if (pending.is_checkpoint) {
    result_.checkpoints.push_back(point);
    if (hooks_.checkpoint && film_) { // comparing with a reference is not rendering
      pause_clock();
      hooks_.checkpoint(point, develop(*film_, settings_.aovs, workspace_.scene.origin));
      resume_clock();
    }
  }
  if (settings_.target_error > 0.0 && !stopped_) aim(pending, point);
}

// Ends the render where its target is reached, and otherwise predicts the sample at which it may be, to estimate again
// there. Waves that were rendered meanwhile do not count, so that the picture does not depend on timing. The rule is
// about the error of the whole picture, in which one pixel weighs next to nothing: no pixel stops early because its
// error seems small by chance.
void RenderLoop::aim(const Pending& pending, const Checkpoint& point) {
  if (pending.sample == aim_sample_) aim_limit_ = 0;
  if (point.spp >= kFewestSamples && point.error.relative_rms <= settings_.target_error) {
    stop(StopReason::target_error);
    queue_.drain();
    pending_.clear(); // of samples that do not count
    aim_limit_ = 0;
    cursor_ = {pending.sample, 0, 0, 0};
    queue_.totals = pending.totals;
    return;
  }
  next_check_ = 0;
  if (!has_estimate(point.spp, point.error) || point.spp < kFewestSamples) return;
  const double growth =
      growth_for(point.error.relative_rms / settings_.target_error, fit_slope(result_.checkpoints, Against::spp));
  const std::uint32_t samples = pending.sample - settings_.first_sample;
  const double step = samples * std::clamp(growth - 1.0, kShortestStep, 1.0);
  next_check_ = pending.sample + look_step(step, settings_.adaptive);
}

bool RenderLoop::is_save_due() const { return hooks_.save && seconds_since(last_save_) >= hooks_.save_interval; }

void RenderLoop::save() {
  queue_.drain();
  collect_estimates(true);
  pause_clock();
  hooks_.save(state());
  last_save_ = Clock::now();
  resume_clock();
}

RenderState RenderLoop::state() {
  return {cursor_,
          settings_.first_sample,
          seconds(),
          result_.estimate_seconds,
          queue_.totals.stages,
          queue_.totals.rays,
          queue_.totals.nonfinite,
          result_.checkpoints,
          levels_,
          next_check_,
          has_film() ? *film_ : workspace_.film.download()};
}

RenderResult RenderLoop::finish() {
  queue_.drain();
  pause_clock();
  const double seconds_rendered = seconds();
  collect_estimates(true);
  pause_clock();
  result_.even = !in_pass() && !settings_.adaptive;
  if (hooks_.save) hooks_.save(state());
  if (!has_film()) { // the last pass was no checkpoint, or was cut short
    Pending whole;
    whole.point.spp = samples_per_pixel();
    measure(whole);
    whole.point.seconds = seconds_rendered;
    film_ = std::make_shared<const Film>(workspace_.film.download());
    film_sample_ = cursor_.sample;
    whole.point.error = estimate_error(*film_);
    last_ = whole.point;
  }
  result_.picture = develop(*film_, settings_.aovs, workspace_.scene.origin);
  result_.spp = samples_per_pixel(); // of complete passes; one cut short has given some pixels more
  result_.nonfinite = queue_.totals.nonfinite;
  result_.seconds = last_.seconds;
  result_.gpu_seconds = last_.gpu_seconds;
  result_.rays = last_.rays;
  result_.error = last_.error;
  const std::uint32_t known = result_.checkpoints.empty() ? 0 : result_.checkpoints.back().spp;
  if (last_.spp != known) { // ended by time, target or interrupt
    result_.checkpoints.push_back(last_);
    if (hooks_.checkpoint) hooks_.checkpoint(last_, result_.picture);
  }
  result_.slope = fit_slope(result_.checkpoints, Against::seconds);
  result_.stages = queue_.totals.stages;
  result_.memory = memory();
  integrator_->describe(result_);
  result_.film = std::move(film_);
  return std::move(result_);
}

} // namespace wavepath
