#include "host/render/loop/render_loop.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "host/base/clock.h"
#include "host/base/process_clock.h"
#include "host/film/error.h"
#include "host/render/loop/adaptive.h"
#include "host/render/loop/segments.h"
#include "host/render/settings/adaptivity.h"
#include "host/render/settings/probing.h"
#include "host/render/settings/traversal.h"
#include "host/render/settings/worthwhile.h"
#include "kernels/base/error_probes.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kAdaptivePass = 16; // samples

// Windows, and renders that end by the clock, want to be asked again soon.
std::uint32_t first_wave(const DeviceInfo& device, const LoopPolicy& policy, const RenderPlan& settings) {
  const bool waits = !policy.by_wave && !(settings.time_limit > 0.0);
  return device.type == "cpu" && waits ? kFirstWaveOfCpu : kFirstWave;
}

RenderPlan whole_passes(RenderPlan settings) {
  if (!is_adaptive(settings)) return settings;
  settings.first_sample = whole_steps(settings.first_sample);
  settings.last_sample = whole_steps(settings.last_sample);
  return settings;
}

// Distance between looks at the error: a multiple of the samples that give all replicates, and all levels, equally
// many.
Target make_target(const RenderPlan& settings, bool has_levels, std::uint32_t next_check = 0) {
  const std::uint32_t step = has_levels ? kAdaptiveStep : gpu::kReplicates;
  return {settings.target_error, settings.first_sample, settings.last_sample, step, next_check};
}

// True if an estimate runs before the next wave. A CPU device computes on the cores that the estimate needs: together,
// both take longer than one after the other (1.5 to 2.7 % of a render). A window has no time to wait for it.
bool are_at_once(const DeviceInfo& device, const LoopPolicy& policy) {
  return device.type == "cpu" && policy.estimates == Estimates::all;
}

} // namespace

RenderLoop::RenderLoop(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                       KernelCompiler& kernels, RenderHooks hooks, const LoopPolicy& policy,
                       std::shared_ptr<const DeviceScene> uploaded)
    : settings_(settings),
      hooks_(std::move(hooks)),
      policy_(policy),
      kernels_(kernels),
      workspace_(
          device, scene,
          std::clamp(choose_slots(device.info(), scene.features, settings), policy.least_slots, policy.most_slots),
          traversal_of(settings), std::move(uploaded)),
      queue_(workspace_),
      governor_(workspace_.slots, policy.longest_dispatch, first_wave(device.info(), policy, settings)),
      estimates_(device),
      estimates_at_once_(are_at_once(device.info(), policy)) {
  restart(view, settings);
}

RenderLoop::~RenderLoop() {
  queue_.abandon(); // before anything is destroyed that waves in flight or estimates use
}

// Discards what is in flight. Estimates in progress end by themselves, each with the copy of the film that it holds.
void RenderLoop::abandon() {
  abandoning_ = true;
  queue_.drain();
  abandoning_ = false;
  for (Pending& pending : pending_)
    if (pending.estimate.valid())
      estimates_.abandon(std::move(pending.estimate));
    else if (pending.copy)
      estimates_.give_back(std::move(pending.copy));
  pending_.clear();
}

void RenderLoop::restart(const View& view, const RenderPlan& settings, TemporalHistory history) {
  abandon();
  settings_ = whole_passes(settings);
  if (kind_ != settings.integrator) integrator_.reset(); // the device may not hold both at once
  kind_ = settings.integrator;
  if (!integrator_) integrator_ = kind_->make(workspace_, kernels_);
  workspace_.change(view, settings_);
  integrator_->change(view, settings_, history);
  workspace_.film.clear();
  queue_.totals = {};
  pass_began_busy_ = 0.0;
  segments_ = all_segments(workspace_.film);
  levels_.clear();
  mean_factor_ = 1.0;
  cursor_ = {settings_.first_sample, 0, 0, 0};
  begun_ = stopped_ = running_ = false;
  target_ = make_target(settings_, false);
  film_.reset();
  result_ = {};
  result_.upload_seconds = workspace_.upload_seconds;
  result_.by_query = workspace_.on_device->queries.has_value();
  saved_sample_ = 0;
  next_show_ = {};
  seconds_before_ = 0.0;
}

void RenderLoop::restart(const View& view, const RenderPlan& settings, RenderHooks hooks) {
  hooks_ = std::move(hooks);
  restart(view, settings);
}

bool RenderLoop::can_render(const RenderPlan& settings) const {
  if (settings.time_limit > 0.0) return false; // its first waves are short
  const DeviceInfo& info = workspace_.device.info();
  return choose_slots(info, workspace_.scene.features, settings) <= workspace_.slots &&
         traces_by_query(traversal_of(settings), info) == workspace_.on_device->queries.has_value();
}

double RenderLoop::seconds() const {
  if (policy_.clock_is_busy_time) return queue_.totals.busy_seconds;
  return seconds_before_ + (running_ ? seconds_since(clock_start_) : 0.0);
}

void RenderLoop::resume_clock() {
  clock_start_ = Clock::now();
  running_ = true;
}

void RenderLoop::pause_clock() {
  seconds_before_ = running_ ? seconds_before_ + seconds_since(clock_start_) : seconds_before_;
  running_ = false;
}

void RenderLoop::stop(StopReason reason) {
  if (!stopped_) result_.stop = reason;
  stopped_ = true;
}

// A frame reaches the film as a whole, so it is never cut short.
bool RenderLoop::is_done() const {
  if (stopped_) return traces_paths() || !in_pass();
  return cursor_.sample >= settings_.last_sample && target_.limit() == 0;
}

bool RenderLoop::step() {
  collect_estimates(false);
  if (!begun_) begin();
  if (target_.limit() > 0 && !in_pass() && cursor_.sample >= target_.limit()) collect_estimates(true);
  if (is_done()) return false;
  if (!in_pass()) {
    cursor_.pass_samples = pass_end() - cursor_.sample;
    integrator_->begin_pass(queue_, cursor_.sample);
  }
  submit_next_wave();
  if (is_pass_submitted()) end_pass();
  if (is_save_due() && (traces_paths() || !in_pass())) save();
  if (is_publish_due()) publish();
  if (is_show_due()) show();
  return true;
}

// Does what comes before the first sample: pilots, and restoring the state of an earlier render.
void RenderLoop::begin() {
  begun_ = true;
  result_.compile_seconds = integrator_->get_ready();
  resume_clock();
  for (bool goes_on = true; goes_on;) {
    const auto pilot = integrator_->pilot();
    if (pilot) explore(*pilot);
    goes_on = pilot && !stopped_ && integrator_->end_pilot();
  }
  if (hooks_.resume) restore(*hooks_.resume);
  last_save_ = last_publish_ = Clock::now();
  if (hooks_.resume && !stopped_ && is_look_due()) checkpoint(); // the interrupt came before it
  if (is_adaptive(settings_) && spp() == 0 && !in_pass()) adapt_levels();
  pass_began_busy_ = queue_.totals.busy_seconds; // of no pass
}

void RenderLoop::restore(const RenderState& state) {
  cursor_ = state.cursor;
  seconds_before_ = state.seconds;
  result_.estimate_seconds = state.estimate_seconds;
  result_.checkpoints = state.checkpoints;
  if (!state.checkpoints.empty()) result_.error = state.checkpoints.back().error;
  queue_.totals.rays = state.rays;
  queue_.totals.stages = state.stages;
  queue_.totals.nonfinite = state.nonfinite;
  workspace_.film.upload(state.film);
  result_.noise = state.noise;
  if (!state.levels.empty()) use_levels(state.levels);
  target_ = make_target(settings_, !levels_.empty(), state.next_check);
  if (in_pass()) integrator_->begin_pass(queue_, cursor_.sample);
}

bool RenderLoop::is_look_due() const {
  if (in_pass() || spp() == 0) return false;
  const bool known = !result_.checkpoints.empty() && result_.checkpoints.back().spp == samples_per_pixel();
  return is_check() || (is_checkpoint() && !known);
}

// Renders the pilot, whose samples do not reach the picture.
void RenderLoop::explore(const Pilot& pilot) {
  exploring_ = true;
  const gpu::Frame frame = workspace_.frame;
  workspace_.frame.seed ^= pilot.seed;
  if (pilot.width > 0) { // of the whole picture, whichever part the film holds
    workspace_.frame.width = workspace_.frame.film_width = pilot.width;
    workspace_.frame.height = workspace_.frame.film_height = pilot.height;
    workspace_.frame.film_left = workspace_.frame.film_top = 0;
  }
  if (pilot.splits_replicates) workspace_.frame.probes = gpu::kProbesNone;
  if (!pilot.reuses_paths) workspace_.frame.reuses_paths = 0;
  if (workspace_.frame.reuses_paths && pilot.width > 0) // pixels that share are as close as in the picture
    workspace_.frame.quad_scale *= static_cast<float>(pilot.width) / static_cast<float>(frame.width);
  workspace_.send_frame();
  integrator_->begin_pass(queue_, 0);
  // A pilot of a small picture may have more samples of a pixel than a wave can hold.
  const std::uint32_t capacity = std::max(sample_capacity(), 1u);
  const std::uint32_t end = pilot.first_sample + pilot.samples;
  for (const Segment& segment : pilot.segments)
    for (std::uint32_t first = pilot.first_sample; first < end; first += std::min(capacity, end - first))
      for (std::uint32_t done = 0; done < segment.pixel_count && !stopped_;) {
        const std::uint32_t count = std::min(capacity, end - first), taken = fitting(segment, done, count, 0);
        submit_wave(segment.band, wave_of(segment, done, taken, first, count),
                    taken * integrator_->paths_per_pixel(count));
        done += taken;
      }
  queue_.drain();
  exploring_ = false;
  workspace_.frame = frame;
  workspace_.send_frame();
  queue_.totals.nonfinite = {};
}

// Renders the noise pilot and distributes samples by it. If it is interrupted, a resumed render makes it instead.
void RenderLoop::adapt_levels() {
  const FilmShape shape = noise_pilot_shape(workspace_.film);
  const bool open_ended = settings_.time_limit > 0.0 || settings_.target_error > 0.0; // it may be short
  const std::uint32_t samples = open_ended ? kFewestPilotSamples : noise_pilot_samples(planned(), whole_pixels());
  explore({.segments = {{0, 0, static_cast<std::uint32_t>(shape.pixels()), 0}},
           .samples = samples,
           .seed = kAdaptivePilotSeed,
           .width = shape.width,
           .height = shape.height,
           .splits_replicates = true});
  if (!stopped_) {
    const Film noise = workspace_.film.download_small(shape);
    const int lowest = has_error_probes(settings_) ? kLowestLevel : kLowestLevelOfSplitReplicates;
    const SampleDistribution distribution =
        distribute_samples(noise, workspace_.frame.width, workspace_.frame.height, lowest);
    const bool pays = settings_.adaptive == kAdaptiveOn || distribution.cost < kWorthwhile;
    result_.noise = NoisePilot{samples, shape.width, shape.height, distribution.cost, pays};
    if (pays) use_levels(distribution.levels);
    target_ = make_target(settings_, pays);
  }
  workspace_.film.clear();
}

void RenderLoop::use_levels(const std::vector<std::int8_t>& levels) {
  levels_ = levels;
  std::vector<std::uint32_t> entries;
  segments_ = level_segments(workspace_.film, levels, entries);
  workspace_.set_entries(std::move(entries));
  const FilmShape& shape = workspace_.film.shape();
  mean_factor_ = shape.is_part() ? mean_factor(levels, shape) : mean_factor(levels, pixels());
}

// End of the pass in progress. A pass gives every pixel the same samples: one, or as many as fill a wave. It ends at
// checkpoints and where the error is estimated between two.
std::uint32_t RenderLoop::pass_end() const {
  const std::uint32_t step = levels_.empty() ? 1 : kAdaptiveStep;
  const std::uint32_t wave = policy_.fixed_wave ? policy_.fixed_wave : governor_.wave();
  const std::uint64_t most = integrator_->most_samples(cursor_.sample);
  auto fit = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(wave / entries(), 1, most));
  if (!levels_.empty()) { // every pass ends with a wave that is not full: longer ones have fewer
    const std::uint64_t bound = std::min<std::uint64_t>(most, sample_capacity()) / kHighestFactor;
    fit =
        static_cast<std::uint32_t>(std::clamp<std::uint64_t>(std::max(fit, kAdaptivePass), step, bound / step * step));
  }
  // Counted from the first sample, because indices end at 2^32 - 1, which a sum may pass.
  const std::uint64_t full = spp() + (std::uint64_t{fit} + step - 1) / step * step;
  const std::uint64_t next_checkpoint = std::max(std::bit_ceil(spp() + std::uint64_t{1}), std::uint64_t{step});
  const std::uint64_t length = std::min({full, next_checkpoint, std::uint64_t{planned()}});
  std::uint32_t end = settings_.first_sample + static_cast<std::uint32_t>(length);
  for (const std::uint32_t bound : {target_.next_check(), target_.limit()})
    if (bound > cursor_.sample) end = std::min(end, bound);
  return end;
}

// Samples of a wave's smallest unit, a pixel or a quad, for which there are slots.
std::uint32_t RenderLoop::sample_capacity() const {
  const std::uint32_t least = workspace_.film.shape().quads ? gpu::kQuadPixels : 1;
  return workspace_.slots / (least * integrator_->paths_per_pixel(1));
}

// Number of further pixels of a segment that join a wave of `slots` paths so far, with `count` samples each. `done`
// pixels of the segment have their samples already. Returns as many as the wave holds, but at least one pixel or quad.
// Waves are cut here only, never within a quad, whose entries are side by side in a segment.
std::uint32_t RenderLoop::fitting(const Segment& segment, std::uint32_t done, std::uint32_t count,
                                  std::uint32_t slots) const {
  const std::uint32_t paths = integrator_->paths_per_pixel(count);
  const std::uint32_t capacity = policy_.fixed_wave ? policy_.fixed_wave : governor_.wave();
  const std::uint32_t fit = capacity > slots ? (capacity - slots) / paths : 0, left = segment.pixel_count - done;
  if (fit >= left) return left;
  if (!workspace_.film.shape().quads) return slots == 0 ? std::max(fit, 1u) : fit;
  const gpu::Frame& frame = workspace_.frame; // the pilot's own during a pilot
  const std::uint32_t next = segment.first_entry + done, beyond = workspace_.entry_at(next + fit);
  const std::uint32_t whole = fit - gpu::rank_in_quad(beyond, frame.film_width * frame.film_height);
  if (whole > 0 || slots > 0) return whole;
  return gpu::quad_entries(workspace_.entry_at(next), {frame.film_left, frame.film_top, frame.film_width,
                                                       frame.film_height, frame.width, frame.height});
}

gpu::Wave RenderLoop::wave_of(const Segment& segment, std::uint32_t done, std::uint32_t taken, std::uint32_t first,
                              std::uint32_t count) const {
  const std::uint32_t index = segment.first_entry + done;
  const FilmBand& band = workspace_.film.bands()[segment.band];
  gpu::Wave wave = integrator_->wave(band, workspace_.entry_at(index), taken, first, count);
  wave.first_pixel = index;
  if (exploring_ && workspace_.film.shape().is_part()) wave.first_film_pixel = 0; // a pilot's film begins its band
  return wave;
}

void RenderLoop::submit_wave(std::size_t band, const gpu::Wave& wave, std::uint32_t slots) {
  WaveQueue::Work work{.timed_dispatches = integrator_->timed_dispatches(), .wave = wave};
  work.done = [this, slots](const Finished& finished) {
    const bool timed = finished.longest_dispatch > 0.0 && !policy_.by_wave; // else the whole wave bounds each dispatch
    const double whole = finished.device_seconds > 0.0 ? finished.device_seconds : finished.seconds;
    governor_.report(timed ? finished.longest_dispatch : whole, slots);
    report_progress();
  };
  queue_.submit([&](Commands& commands) { integrator_->record_wave(commands, band, wave); }, std::move(work));
}

// Submits the next wave of the pass. Levels share a wave, since one level alone may have few pixels.
void RenderLoop::submit_next_wave() {
  const Segment first = segments_[cursor_.segment];
  gpu::Wave wave = wave_of(first, cursor_.pixels_done, 0, cursor_.sample, cursor_.pass_samples);
  std::uint32_t slots = 0;
  while (!is_pass_submitted()) {
    const Segment& segment = segments_[cursor_.segment];
    const gpu::Wave more = wave_of(segment, cursor_.pixels_done, 0, cursor_.sample, cursor_.pass_samples);
    if (segment.band != first.band || more.first_film_pixel != wave.first_film_pixel) break;
    const std::uint32_t count = at_level(cursor_.pass_samples, segment.level);
    const std::uint32_t taken = fitting(segment, cursor_.pixels_done, count, slots);
    wave.pixel_count += taken;
    wave.level_entries[kHighestLevel - segment.level] += taken;
    slots += taken * integrator_->paths_per_pixel(count);
    cursor_.pixels_done += taken;
    if (cursor_.pixels_done < segment.pixel_count) break;
    ++cursor_.segment;
    cursor_.pixels_done = 0;
  }
  submit_wave(first.band, wave, slots);
}

void RenderLoop::end_pass() {
  integrator_->end_pass(queue_);
  if (spp() == 0) queue_.afterwards([this] { result_.first_pixel_seconds = seconds_since_process_start(); });
  queue_.afterwards([this, samples = cursor_.pass_samples * static_cast<double>(pixels())] {
    pixel_seconds_ = (queue_.totals.busy_seconds - pass_began_busy_) / samples;
    pass_began_busy_ = queue_.totals.busy_seconds;
  });
  cursor_ = {cursor_.sample + cursor_.pass_samples, 0, 0, 0};
  // The decision of the last look must be known before the next look begins, whatever the timing.
  if (target_.limit() > 0 && (cursor_.sample >= target_.limit() || is_checkpoint())) collect_estimates(true);
  if (!stopped_ && (is_checkpoint() || is_check())) checkpoint();
}

std::uint32_t RenderLoop::samples_per_pixel() const {
  return static_cast<std::uint32_t>(std::lround(spp() * mean_factor_));
}

Progress RenderLoop::progress() const {
  double done = cursor_.pixels_done;
  for (std::uint32_t i = 0; i < cursor_.segment; ++i) done += segments_[i].pixel_count;
  Progress progress;
  progress.spp_done = spp();
  progress.spp_planned = planned();
  progress.fraction = (spp() + cursor_.pass_samples * done / static_cast<double>(entries())) / progress.spp_planned;
  progress.seconds = seconds();
  const double rays = static_cast<double>(queue_.totals.rays.total());
  progress.mrays_per_second = progress.seconds > 0.0 ? rays * 1e-6 / progress.seconds : 0.0;
  progress.error = result_.error;
  progress.slope = fit_slope(result_.checkpoints, Against::seconds);
  return progress;
}

// The first pass is always completed, so that every pixel has a value.
bool RenderLoop::is_first_pass_complete() const { return !traces_paths() || spp() > 0 || is_pass_submitted(); }

void RenderLoop::report_progress() {
  if (abandoning_) return;
  if (!hooks_.progress && settings_.time_limit <= 0.0) return;
  const Progress now = progress();
  if (hooks_.progress && !hooks_.progress(now)) stop(StopReason::interrupted);
  if (settings_.time_limit > 0.0 && now.seconds >= settings_.time_limit && !exploring_ && is_first_pass_complete())
    stop(StopReason::time);
}

MemoryUse RenderLoop::memory() const {
  MemoryUse use;
  use.bvh = workspace_.on_device->bvh_bytes();
  use.scene = workspace_.on_device->other_bytes();
  use.paths = workspace_.bytes() + integrator_->bytes();
  use.film = workspace_.film.bytes();
  return use;
}

std::shared_ptr<const Film> RenderLoop::of_picture(std::shared_ptr<const Film> film) const {
  if (!settings_.crop) return film;
  return std::make_shared<const Film>(cut(*film, picture_shape(settings_)));
}

Film RenderLoop::film() {
  queue_.drain();
  return workspace_.film.download();
}

} // namespace wavepath
