// Checkpoints of the render loop: estimates of the error during the next waves, the target, states to resume from, and
// the result.
#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>

#include "host/base/clock.h"
#include "host/film/error.h"
#include "host/render/loop/adaptive.h"
#include "host/render/loop/render_loop.h"

namespace wavepath {
namespace {

// Limit of estimates in progress; each holds a copy of the film.
constexpr std::size_t kMostPending = 2;
constexpr double kEstimateFraction = 0.02; // of the render's time, where estimates may be skipped
constexpr std::chrono::seconds kShowInterval{1};
constexpr int kShowPause = 19;          // pause between pictures shown, in durations of showing one
constexpr double kFirstEstimate = 1e-7; // assumed seconds a pixel of the first estimate

double gpu_seconds(const Totals& totals) {
  double sum = 0.0;
  for (const StageTime& stage : totals.stages) sum += stage.seconds;
  return sum;
}

ErrorEstimate unknown_error() {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  return {kUnknown, {kUnknown, kUnknown}, 0.0};
}

} // namespace

bool RenderLoop::is_checkpoint() const { return std::has_single_bit(spp()) || cursor_.sample == settings_.last_sample; }

// False if an estimate is not worth its time: those of coarse pictures in a window, and long ones.
bool RenderLoop::pays() const {
  if (policy_.estimates != Estimates::cheap) return policy_.estimates == Estimates::all;
  if (settings_.antialias_over_time || spp() < gpu::kReplicates) return false;
  if (cursor_.sample == settings_.last_sample) return true;
  const double cost =
      static_cast<double>(pixels()) * (estimate_pixel_seconds_ > 0.0 ? estimate_pixel_seconds_ : kFirstEstimate);
  return pending_.empty() && result_.estimate_seconds + cost <= kEstimateFraction * seconds();
}

// True if this checkpoint gets an estimate. If too many are in progress, the device would have to wait. So an estimate
// that decides nothing is left out: at 1920x1080 it takes as long as a fast GPU takes for 60 samples of the Cornell
// box.
bool RenderLoop::gets_estimate() const {
  if (spp() < gpu::kReplicates && !hooks_.checkpoint) return false; // there is no estimate of fewer samples
  const bool decides = settings_.target_error > 0.0 || hooks_.checkpoint || cursor_.sample == settings_.last_sample;
  return estimates_at_once_ || decides || copies_in_use() < kMostPending;
}

std::size_t RenderLoop::copies_in_use() const {
  return static_cast<std::size_t>(std::ranges::count_if(pending_, [](const Pending& p) { return p.copy != nullptr; }));
}

// Makes a checkpoint: the device copies the film, and its error is estimated during the next waves.
void RenderLoop::checkpoint() {
  if (!pays()) return;
  collect_estimates(false);
  const bool estimates = gets_estimate();
  while (estimates && copies_in_use() >= kMostPending) take_in_first();
  if (estimates_at_once_) queue_.drain();
  if (stopped_) return; // meanwhile; a render that is resumed takes this look first
  Pending& pending = pending_.emplace_back();
  pending.sample = cursor_.sample;
  pending.is_checkpoint = is_checkpoint();
  pending.point.spp = samples_per_pixel();
  target_.begin(cursor_.sample, pending.point.spp);
  if (!estimates) {
    queue_.afterwards([this, &pending] { measure(pending); });
    return;
  }
  if (estimates_at_once_) {
    measure(pending);
    pending.estimate = estimate_now(workspace_.film, picture_shape(settings_));
    return;
  }
  queue_.submit([&](Commands& commands) { pending.copy = estimates_.copy(commands, workspace_.film); },
                {.done = [this, &pending](const Finished&) { measure(pending); }});
}

// Called when the device has reached the checkpoint: notes time and counts, and begins the estimate.
void RenderLoop::measure(Pending& pending) {
  if (abandoning_) return;
  pending.totals = queue_.totals;
  pending.point.seconds = seconds();
  pending.point.gpu_seconds = gpu_seconds(queue_.totals);
  pending.point.rays = queue_.totals.rays;
  pending.point.error = unknown_error();
  pending.measured = true;
  if (pending.copy) pending.estimate = estimates_.begin(pending.copy, picture_shape(settings_));
}

void RenderLoop::collect_estimates(bool wait) {
  while (!pending_.empty()) {
    const Pending& first = pending_.front();
    const bool ready = first.measured && (!first.estimate.valid() || is_there(first.estimate));
    if (!ready && !wait) return;
    take_in_first();
  }
}

// Moves the oldest checkpoint into the result, when its estimate is finished.
void RenderLoop::take_in_first() {
  while (!pending_.front().measured && queue_.finish_one()) {
  }
  Pending pending = std::move(pending_.front());
  pending_.pop_front();
  Checkpoint& point = pending.point;
  const bool has_error = pending.estimate.valid();
  if (has_error) {
    FilmEstimate estimate = pending.estimate.get();
    point.error = estimate.error;
    film_ = std::move(estimate.film);
    film_sample_ = pending.sample;
    film_totals_ = pending.totals;
    estimate_pixel_seconds_ = estimate.seconds / static_cast<double>(pixels());
    result_.estimate_seconds += estimate.seconds;
    if (pending.copy) estimates_.give_back(std::move(pending.copy));
  }
  if (has_error) last_ = point; // of film_
  if (has_error || result_.checkpoints.empty()) result_.error = point.error;
  if (pending.is_checkpoint) {
    result_.checkpoints.push_back(point);
    if (hooks_.checkpoint && film_) { // comparing with a reference is not rendering
      pause_clock();
      hooks_.checkpoint(point,
                        develop(*of_picture(film_), settings_.aovs, workspace_.scene.origin, settings_.group_names));
      resume_clock();
    }
  }
  const bool ends = target_.take(pending.sample, point, result_.checkpoints);
  if (film_sample_ == pending.sample) film_next_check_ = target_.next_check();
  if (ends) stop_at(pending);
}

// Ends the render with the film that was judged. Later waves do not count, so that the picture does not depend on
// timing.
void RenderLoop::stop_at(const Pending& judged) {
  stopped_ = true;
  result_.stop = StopReason::target_error; // even if time or the user stopped what came after
  abandon();
  cursor_ = {judged.sample, 0, 0, 0};
  queue_.totals = judged.totals;
}

bool RenderLoop::is_save_due() const { return hooks_.save && seconds_since(last_save_) >= hooks_.save_interval; }

void RenderLoop::save() {
  queue_.drain();
  collect_estimates(true);
  pause_clock();
  hooks_.save(state());
  saved_sample_ = cursor_.sample;
  last_save_ = Clock::now();
  resume_clock();
}

bool RenderLoop::is_publish_due() const {
  return hooks_.publish && !in_pass() && !is_done() && seconds_since(last_publish_) >= hooks_.publish_interval;
}

// What finish() would give, while the render goes on.
void RenderLoop::publish() {
  queue_.drain();
  collect_estimates(true);
  if (stopped_) return;
  const auto film = of_picture(std::make_shared<const Film>(workspace_.film.download()));
  pause_clock();
  RenderResult so_far = result_;
  so_far.film = film;
  so_far.picture = develop(*film, settings_.aovs, workspace_.scene.origin, settings_.group_names);
  so_far.spp = samples_per_pixel();
  so_far.stop = StopReason::interrupted;
  so_far.even = levels_.empty();
  so_far.error = estimate_error(*film);
  so_far.seconds = seconds();
  so_far.gpu_seconds = gpu_seconds(queue_.totals);
  so_far.rays = queue_.totals.rays;
  so_far.stages = queue_.totals.stages;
  so_far.nonfinite = queue_.totals.nonfinite;
  so_far.slope = fit_slope(so_far.checkpoints, Against::seconds);
  so_far.memory = memory();
  hooks_.publish(so_far);
  last_publish_ = Clock::now();
  resume_clock();
}

bool RenderLoop::is_show_due() const {
  const bool has_picture = is_first_pass_complete() && (traces_paths() || !in_pass());
  return hooks_.show && has_picture && Clock::now() >= next_show_;
}

void RenderLoop::show() {
  const auto film = std::make_shared<const Film>(this->film());
  pause_clock();
  const Clock::time_point start = Clock::now();
  hooks_.show(develop(*of_picture(film), settings_.aovs, workspace_.scene.origin, settings_.group_names));
  const Clock::duration taken = Clock::now() - start;
  next_show_ = Clock::now() + std::max<Clock::duration>(kShowInterval, kShowPause * taken);
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
          result_.noise,
          result_.stop == StopReason::device_lost ? film_next_check_ : target_.next_check(),
          has_film() ? *film_ : workspace_.film.download()};
}

RenderResult RenderLoop::salvage(const DeviceLost& lost) {
  queue_.abandon();
  while (!pending_.empty() && pending_.front().measured) take_in_first(); // their films have left the device
  pending_.clear();
  if (!film_) throw lost;
  if (result_.stop != StopReason::target_error) result_.stop = StopReason::device_lost;
  cursor_ = {film_sample_, 0, 0, 0};
  queue_.totals = film_totals_;
  // Later ones went without an estimate, and so without a film.
  std::erase_if(result_.checkpoints, [&](const Checkpoint& c) { return c.spp > last_.spp; });
  return finish();
}

RenderResult RenderLoop::finish() {
  queue_.drain();
  pause_clock();
  const double seconds_rendered = seconds();
  collect_estimates(true);
  pause_clock();
  result_.even = !in_pass() && levels_.empty();
  const bool saved_more = result_.stop == StopReason::device_lost && saved_sample_ >= cursor_.sample;
  if (hooks_.save && !saved_more) hooks_.save(state());
  if (!has_film()) { // the last pass was no checkpoint, or was cut short
    Pending whole;
    whole.point.spp = samples_per_pixel();
    measure(whole);
    whole.point.seconds = seconds_rendered;
    film_ = std::make_shared<const Film>(workspace_.film.download());
    film_sample_ = cursor_.sample;
    film_totals_ = queue_.totals;
    whole.point.error = estimate_error(*of_picture(film_));
    last_ = whole.point;
  }
  film_ = of_picture(std::move(film_)); // the state is saved
  result_.picture = develop(*film_, settings_.aovs, workspace_.scene.origin, settings_.group_names);
  result_.spp = samples_per_pixel(); // samples of complete passes; a pass that was cut short has given some pixels more
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
  try {
    integrator_->describe(result_);
  } catch (const DeviceLost&) { // its measurements until then are kept; the picture is complete
  }
  result_.film = std::move(film_);
  return std::move(result_);
}

} // namespace wavepath
