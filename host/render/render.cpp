// The render loop: waves until the samples, the time or the target error is reached; checkpoints on the way.
#include "host/integrators/path/film_transfer.h"
#include "host/render/render.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/process_clock.h"
#include "host/render/adaptive.h"
#include "host/film/error.h"
#include "host/film/film.h"
#include "host/render/governor.h"
#include "host/render/integrator.h"
#include "host/integrators/hybrid/hybrid.h"
#include "host/integrators/path/path_tracer.h"
#include "host/render/render_state.h"

namespace wavepath {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Pixels that get the same number of samples: a band of the film, or of an adaptive render a level within a band.
struct Segment {
  const FilmBand* band = nullptr;
  std::uint32_t first_place = 0, pixel_count = 0; // in tile order, or in the order of the list of runs
  int level = 0;
};

std::vector<Segment> even_segments(const std::vector<FilmBand>& bands) {
  std::vector<Segment> segments;
  for (const FilmBand& band : bands) segments.push_back({&band, band.first_pixel, band.pixel_count, 0});
  return segments;
}

// Sorts the runs of each band by level; `runs` becomes the list that places refer to.
std::vector<Segment> level_segments(const std::vector<FilmBand>& bands, const std::vector<std::int8_t>& levels,
                                    std::vector<std::uint32_t>& runs) {
  std::vector<Segment> segments;
  for (const FilmBand& band : bands)
    for (int level = kLowestLevel; level <= kHighestLevel; ++level) {
      Segment segment{&band, static_cast<std::uint32_t>(runs.size()) * gpu::kRunPixels, 0, level};
      const std::uint32_t end = band.first_pixel + band.pixel_count;
      for (std::uint32_t first = band.first_pixel; first < end; first += gpu::kRunPixels) {
        if (levels[first / gpu::kRunPixels] != level) continue;
        runs.push_back(first / gpu::kRunPixels);
        segment.pixel_count += std::min(gpu::kRunPixels, end - first); // only the picture's last run is shorter
      }
      if (segment.pixel_count > 0) segments.push_back(segment);
    }
  return segments;
}

// One render in progress.
class Session {
public:
  Session(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
          const RenderHooks& hooks, KernelCompiler& kernels)
      : settings_(settings),
        hooks_(hooks),
        tracer_(device, scene, view, settings, choose_slots(device.info(), scene, settings), kernels),
        governor_(tracer_.slots()),
        origin_(scene.origin),
        segments_(even_segments(tracer_.bands())) {
    if (!settings_.integrator->traces_paths) hybrid_.emplace(device, tracer_, scene, view, settings_);
    if (!settings_.adaptive) return;
    settings_.first_sample = whole_steps(settings_.first_sample);
    settings_.last_sample = whole_steps(settings_.last_sample);
  }

  RenderResult run() {
    result_.compile_seconds = tracer_.get_ready() + (hybrid_ ? hybrid_->get_ready() : 0.0);
    result_.upload_seconds = tracer_.upload_seconds();
    cursor_.sample = settings_.first_sample;
    resume_clock();
    if (hybrid_) hybrid_->estimate_ambient(); // its rays are in the counts that a state restores
    if (hooks_.resume) restore(*hooks_.resume);
    last_save_ = Clock::now();
    if (settings_.adaptive && levels_.empty()) explore();
    while (cursor_.sample < settings_.last_sample && !stopped_) {
      if (cursor_.pass_samples == 0) cursor_.pass_samples = pass_end() - cursor_.sample;
      if (hybrid_)
        render_frame();
      else if (!render_pass())
        break;
      if (spp_done() == 0) result_.first_pixel_seconds = seconds_since_process_start();
      cursor_ = {cursor_.sample + cursor_.pass_samples, 0, 0, 0};
      if (is_checkpoint() || is_check()) checkpoint();
      if (hybrid_ && is_save_due()) save();
    }
    finish();
    return std::move(result_);
  }

private:
  std::uint64_t pixels() const { return std::uint64_t{settings_.width} * settings_.height; }
  std::uint32_t spp_done() const { return cursor_.sample - settings_.first_sample; }
  double seconds() const { return seconds_before_ + (running_ ? seconds_since(clock_start_) : 0.0); }
  void resume_clock() {
    clock_start_ = Clock::now();
    running_ = true;
  }
  void pause_clock() {
    seconds_before_ = seconds();
    running_ = false;
  }

  void restore(const RenderState& state) {
    cursor_ = state.cursor;
    seconds_before_ = state.seconds;
    result_.estimate_seconds = state.estimate_seconds;
    result_.checkpoints = state.checkpoints;
    if (!state.checkpoints.empty()) result_.error = state.checkpoints.back().error;
    tracer_.set_counters(state.counters, state.stages, state.nonfinite);
    upload_film(tracer_, state.film);
    if (settings_.adaptive && !state.levels.empty()) use_levels(state.levels);
  }
  std::uint32_t planned() const { return settings_.last_sample - settings_.first_sample; }

  RenderState state() const {
    return {cursor_,
            settings_.first_sample,
            seconds(),
            result_.estimate_seconds,
            tracer_.stages(),
            tracer_.counters(),
            tracer_.nonfinite(),
            result_.checkpoints,
            levels_,
            download_film(tracer_, settings_.width, settings_.height)};
  }

  // Renders the pilot, learns from it where the noise is, and throws it away.
  void explore() {
    tracer_.set_seed(settings_.seed ^ kPilotSeed);
    for (const Segment& segment : segments_)
      for (std::uint32_t done = 0; done < segment.pixel_count && !stopped_;) {
        done += render_wave(segment, done, 0, kPilotSamples);
        if (hooks_.progress && !hooks_.progress(progress(0.0))) stop(StopReason::interrupted);
      }
    use_levels(choose_levels(download_film(tracer_, settings_.width, settings_.height)));
    tracer_.set_seed(settings_.seed);
    tracer_.empty_film();
  }

  void use_levels(const std::vector<std::int8_t>& levels) {
    levels_ = levels;
    std::vector<std::uint32_t> runs;
    segments_ = level_segments(tracer_.bands(), levels, runs);
    tracer_.set_runs(runs);
    mean_factor_ = mean_factor(levels, pixels());
  }

  // A pass covers every pixel with the same samples: one, or as many as fill a wave, but never across a checkpoint or a
  // check of the error.
  std::uint32_t pass_end() const {
    if (hybrid_) return cursor_.sample + 1; // a frame
    constexpr std::uint64_t kMostSamples = 4096; // accumulate loops over them; Mesa 22.3 ends loops at 65,535 trips
    const std::uint64_t most = settings_.adaptive ? tracer_.slots() / kLargestRun * kAdaptiveStep : kMostSamples;
    const auto fit = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(governor_.wave() / pixels(), 1, most));
    const std::uint32_t step = settings_.adaptive ? kAdaptiveStep : 1;
    const std::uint32_t next_checkpoint = settings_.first_sample + std::max(std::bit_ceil(spp_done() + 1), step);
    std::uint32_t end =
        std::min({cursor_.sample + (fit + step - 1) / step * step, next_checkpoint, settings_.last_sample});
    if (next_check_ > cursor_.sample) end = std::min(end, next_check_);
    return end;
  }

  // Renders samples [first, first + count) of as many pixels of a segment as a wave holds; returns how many.
  std::uint32_t render_wave(const Segment& segment, std::uint32_t done, std::uint32_t first, std::uint32_t count) {
    const std::uint32_t room = std::max(governor_.wave() / count, 1u);
    const std::uint32_t whole_runs = std::max(room / gpu::kRunPixels, 1u) * gpu::kRunPixels;
    const std::uint32_t taken = std::min(settings_.adaptive ? whole_runs : room, segment.pixel_count - done);
    const auto start = Clock::now();
    double longest = tracer_.render_wave(*segment.band, segment.first_place + done, taken, first, count);
    if (longest == 0.0) longest = seconds_since(start); // no timestamps: the whole wave bounds each dispatch
    governor_.report(longest, taken * count);
    return taken;
  }

  // One frame of a hybrid render. It reaches the film as a whole, so that it is not cut short.
  void render_frame() {
    film_.reset();
    hybrid_->begin_frame(cursor_.sample);
    const std::uint32_t samples = hybrid_->samples_per_pixel();
    for (const FilmBand& band : tracer_.bands())
      for (std::uint32_t done = 0; done < band.pixel_count;) {
        const std::uint32_t count = std::min(std::max(governor_.wave() / samples, 1u), band.pixel_count - done);
        const auto start = Clock::now();
        const double longest = hybrid_->render_wave(band, band.first_pixel + done, count);
        governor_.report(longest > 0.0 ? longest : seconds_since(start), count * samples);
        done += count;
        cursor_.pixels_done += count;
        report_progress();
      }
    hybrid_->end_frame();
  }

  // Goes on with the pass that the cursor is in. False if it was cut short.
  bool render_pass() {
    film_.reset(); // no longer what the device holds
    for (; cursor_.segment < segments_.size(); ++cursor_.segment, cursor_.pixels_done = 0) {
      const Segment& segment = segments_[cursor_.segment];
      const std::uint32_t first = at_level(cursor_.sample, segment.level),
                          count = at_level(cursor_.pass_samples, segment.level);
      while (cursor_.pixels_done < segment.pixel_count) {
        cursor_.pixels_done += render_wave(segment, cursor_.pixels_done, first, count);
        report_progress();
        if (is_save_due()) save();
        if (stopped_) return is_pass_done();
      }
    }
    return true;
  }

  bool is_pass_done() const {
    return cursor_.segment + 1 == segments_.size() && cursor_.pixels_done == segments_.back().pixel_count;
  }

  Progress progress(double pass_fraction) const {
    Progress progress;
    progress.spp_done = spp_done();
    progress.spp_planned = planned();
    progress.fraction = (spp_done() + cursor_.pass_samples * pass_fraction) / progress.spp_planned;
    progress.seconds = seconds();
    const double rays = static_cast<double>(ray_counts(tracer_.counters()).total());
    progress.mrays_per_second = progress.seconds > 0.0 ? rays * 1e-6 / progress.seconds : 0.0;
    progress.error = result_.error;
    progress.slope = fit_slope(result_.checkpoints, Against::seconds);
    return progress;
  }

  void report_progress() {
    double done = cursor_.pixels_done;
    for (std::uint32_t i = 0; i < cursor_.segment; ++i) done += segments_[i].pixel_count;
    const Progress now = progress(done / static_cast<double>(pixels()));
    if (hooks_.progress && !hooks_.progress(now)) stop(StopReason::interrupted);
    // The first pass is always completed, so that every pixel has a value.
    const bool complete = hybrid_ || spp_done() > 0 || is_pass_done();
    if (settings_.time_limit > 0.0 && now.seconds >= settings_.time_limit && complete) stop(StopReason::time);
  }

  void stop(StopReason reason) {
    if (!stopped_) result_.stop = reason;
    stopped_ = true;
  }

  bool is_save_due() const { return hooks_.save && seconds_since(last_save_) >= hooks_.save_interval; }

  void save() {
    pause_clock();
    hooks_.save(state());
    last_save_ = Clock::now();
    resume_clock();
  }

  bool is_checkpoint() const { return std::has_single_bit(spp_done()) || cursor_.sample == settings_.last_sample; }
  bool is_check() const { return next_check_ > 0 && cursor_.sample == next_check_; }

  // Without a film there is no estimate.
  Checkpoint measure(const Film* film) {
    Checkpoint point;
    point.spp = samples_per_pixel();
    point.seconds = seconds();
    for (const StageTime& stage : tracer_.stages()) point.gpu_seconds += stage.seconds;
    point.rays = ray_counts(tracer_.counters());
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    point.error = film ? estimate_error(*film) : ErrorEstimate{kUnknown, {kUnknown, kUnknown}, 0.0};
    return point;
  }

  // On average over the picture.
  std::uint32_t samples_per_pixel() const { return static_cast<std::uint32_t>(std::lround(spp_done() * mean_factor_)); }

  // Reading the film and measuring is not rendering.
  void checkpoint() {
    pause_clock();
    const auto start = Clock::now();
    if (spp_done() >= gpu::kReplicates || hooks_.checkpoint) // of fewer samples there is no estimate
      film_ = std::make_shared<const Film>(download_film(tracer_, settings_.width, settings_.height));
    const Checkpoint point = last_ = measure(film_.get());
    result_.estimate_seconds += seconds_since(start);
    result_.error = point.error;
    if (is_checkpoint()) {
      result_.checkpoints.push_back(point);
      if (hooks_.checkpoint) hooks_.checkpoint(point, develop(*film_, settings_.aovs, origin_));
    }
    if (settings_.target_error > 0.0) aim(point);
    resume_clock();
  }

  // Ends the render where its target is reached, and otherwise foresees when that may be, to look again there. Few
  // samples a pixel say little about what they have not yet found, so none is trusted before kFewestSamples. The rule
  // looks at the whole picture, in which one pixel weighs next to nothing: a pixel is not stopped for being lucky.
  void aim(const Checkpoint& point) {
    constexpr std::uint32_t kFewestSamples = 16;
    if (point.spp >= kFewestSamples && point.error.relative_rms <= settings_.target_error)
      return stop(StopReason::target_error);
    next_check_ = 0;
    if (!has_estimate(point.spp, point.error) || point.spp < kFewestSamples) return;
    const double growth =
        growth_for(point.error.relative_rms / settings_.target_error, fit_slope(result_.checkpoints, Against::spp));
    constexpr double kShortestStep = 1.0 / 16; // of what there is: looking costs a little
    const double step = spp_done() * std::clamp(growth - 1.0, kShortestStep, 1.0);
    const std::uint32_t multiple = settings_.adaptive ? kAdaptiveStep : gpu::kReplicates; // all replicates alike
    next_check_ = cursor_.sample + (static_cast<std::uint32_t>(step) / multiple + 1) * multiple;
  }

  void finish() {
    pause_clock();
    result_.even = cursor_.pass_samples == 0 && !settings_.adaptive;
    if (hooks_.save) hooks_.save(state());
    if (!film_) { // the last pass was no checkpoint, or was cut short
      film_ = std::make_shared<const Film>(download_film(tracer_, settings_.width, settings_.height));
      last_ = measure(film_.get());
    }
    const Checkpoint& last = last_;
    result_.picture = develop(*film_, settings_.aovs, origin_);
    result_.spp = samples_per_pixel(); // of complete passes; one cut short has given some pixels more
    result_.nonfinite = tracer_.nonfinite();
    result_.seconds = last.seconds;
    result_.gpu_seconds = last.gpu_seconds;
    result_.rays = last.rays;
    result_.error = last.error;
    const std::uint32_t known = result_.checkpoints.empty() ? 0 : result_.checkpoints.back().spp;
    if (last.spp != known) { // ended by time, target or interrupt
      result_.checkpoints.push_back(last);
      if (hooks_.checkpoint) hooks_.checkpoint(last, result_.picture);
    }
    result_.slope = fit_slope(result_.checkpoints, Against::seconds);
    result_.stages = tracer_.stages();
    result_.memory = tracer_.memory();
    if (hybrid_) result_.memory.paths += hybrid_->bytes();
    if (hybrid_) result_.ambient = hybrid_->ambient();
    result_.film = std::move(film_);
  }

  RenderSettings settings_;
  const RenderHooks& hooks_;
  PathTracer tracer_;
  std::optional<Hybrid> hybrid_; // renders into the tracer's film
  Governor governor_;
  glm::dvec3 origin_;
  std::vector<Segment> segments_;
  std::vector<std::int8_t> levels_;
  double mean_factor_ = 1.0;
  std::shared_ptr<const Film> film_; // as it is on the device, where it was just read
  Checkpoint last_;                  // of that film
  RenderResult result_;
  RenderCursor cursor_;
  std::uint32_t next_check_ = 0; // sample at which to look whether the target is reached; 0 = at checkpoints only
  Clock::time_point clock_start_{}, last_save_{};
  double seconds_before_ = 0.0;
  bool running_ = false, stopped_ = false;
};

} // namespace

RenderResult render(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
                    const ProgressCallback& progress) {
  KernelCompiler kernels(device);
  return render(device, scene, view, settings, RenderHooks{progress}, kernels);
}

RenderResult render(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
                    const RenderHooks& hooks, KernelCompiler& kernels) {
  return Session(device, scene, view, settings, hooks, kernels).run();
}

} // namespace wavepath
