// The render loop: waves until the samples, the time or the target error is reached; checkpoints on the way.
#include "host/render/render.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/process_clock.h"
#include "host/render/film.h"
#include "host/render/path_tracer.h"

namespace wavepath {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kLongestDispatch = 0.1;   // seconds, far below any driver's watchdog
constexpr std::uint32_t kFirstWave = 8192; // paths, before anything is known of the device's speed

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Keeps dispatches short: halves the wave when one took too long, doubles it while there is room.
class Governor {
public:
  explicit Governor(std::uint32_t slots) : slots_(slots), wave_(std::min(slots, kFirstWave)) {}
  std::uint32_t wave() const { return wave_; }
  void report(double longest_dispatch, std::uint32_t paths) {
    if (longest_dispatch > kLongestDispatch)
      wave_ = std::max(std::min(paths, wave_) / 2, gpu::kWorkgroupSize);
    else if (longest_dispatch < kLongestDispatch / 4 && paths > wave_ / 2)
      wave_ = std::min(wave_ * 2, slots_);
  }

private:
  std::uint32_t slots_, wave_;
};

// Slope of log error against log seconds over the last checkpoints whose error is known.
double fit_slope(const std::vector<Checkpoint>& checkpoints) {
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (std::size_t i = checkpoints.size() > 5 ? checkpoints.size() - 5 : 0; i < checkpoints.size(); ++i) {
    const Checkpoint& c = checkpoints[i];
    if (!(c.error.relative_rms > 0.0) || !(c.seconds > 0.0)) continue;
    const double x = std::log(c.seconds), y = std::log(c.error.relative_rms);
    n += 1.0, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  const double determinant = n * sxx - sx * sx;
  constexpr double kMonteCarlo = -0.5; // what any unbiased method does in the limit
  return n >= 3.0 && determinant > 1e-9 ? (n * sxy - sx * sy) / determinant : kMonteCarlo;
}

// One render in progress.
class Session {
public:
  Session(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
          const ProgressCallback& progress, KernelCompiler& kernels)
      : settings_(settings),
        progress_(progress),
        tracer_(device, scene, view, settings, choose_slots(device.info(), scene, settings), kernels),
        governor_(tracer_.slots()),
        origin_(scene.origin) {}

  RenderResult run() {
    result_.compile_seconds = tracer_.get_ready();
    result_.upload_seconds = tracer_.upload_seconds();
    resume_clock();
    sample_ = settings_.first_sample;
    while (sample_ < settings_.last_sample && !stopped_) {
      const std::uint32_t next = pass_end();
      if (!render_pass(next - sample_)) break;
      if (spp_done() == 0) result_.first_pixel_seconds = seconds_since_process_start();
      sample_ = next;
      if (is_checkpoint()) checkpoint();
    }
    finish();
    return std::move(result_);
  }

private:
  std::uint64_t pixels() const { return std::uint64_t{settings_.width} * settings_.height; }
  std::uint32_t spp_done() const { return sample_ - settings_.first_sample; }
  double seconds() const { return seconds_before_ + (running_ ? seconds_since(clock_start_) : 0.0); }
  void resume_clock() {
    clock_start_ = Clock::now();
    running_ = true;
  }
  void pause_clock() {
    seconds_before_ = seconds();
    running_ = false;
  }

  // A pass covers every pixel with the same samples: one, or as many as fill a wave, but never across a checkpoint.
  std::uint32_t pass_end() const {
    constexpr std::uint64_t kMostSamples = 32768; // accumulate loops over them; Mesa 22.3 ends loops at 65,535 trips
    const auto fit = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(governor_.wave() / pixels(), 1, kMostSamples));
    const std::uint32_t next_checkpoint = settings_.first_sample + std::bit_ceil(spp_done() + 1);
    return std::min({sample_ + fit, next_checkpoint, settings_.last_sample});
  }

  // False if it was cut short.
  bool render_pass(std::uint32_t sample_count) {
    for (const FilmBand& band : tracer_.bands())
      for (std::uint32_t done = 0; done < band.pixel_count;) {
        const std::uint32_t room = std::max(governor_.wave() / sample_count, 1u);
        const std::uint32_t count = std::min(room, band.pixel_count - done);
        const auto start = Clock::now();
        double longest = tracer_.render_wave(band, band.first_pixel + done, count, sample_, sample_count);
        if (longest == 0.0) longest = seconds_since(start); // no timestamps: the whole wave bounds each dispatch
        governor_.report(longest, count * sample_count);
        done += count;
        report_progress(band.first_pixel + done, sample_count);
        if (stopped_) return band.first_pixel + done == pixels();
      }
    return true;
  }

  void report_progress(std::uint64_t pixels_done, std::uint32_t sample_count) {
    const double now = seconds();
    const double samples = spp_done() + sample_count * static_cast<double>(pixels_done) / static_cast<double>(pixels());
    Progress progress;
    progress.spp_done = spp_done();
    progress.spp_planned = settings_.last_sample - settings_.first_sample;
    progress.fraction = samples / progress.spp_planned;
    progress.seconds = now;
    const gpu::Queues queues = tracer_.counters();
    progress.mrays_per_second = now > 0.0 ? static_cast<double>(ray_counts(queues).total()) * 1e-6 / now : 0.0;
    progress.error = result_.error;
    if (progress_ && !progress_(progress)) stop(StopReason::interrupted);
    // The first pass is always completed, so that every pixel has a value.
    const bool complete = spp_done() > 0 || pixels_done == pixels();
    if (settings_.time_limit > 0.0 && now >= settings_.time_limit && complete) stop(StopReason::time);
  }

  void stop(StopReason reason) {
    if (!stopped_) result_.stop = reason;
    stopped_ = true;
  }

  bool is_checkpoint() const { return std::has_single_bit(spp_done()) || sample_ == settings_.last_sample; }

  Checkpoint measure(const FilmImage& film) {
    Checkpoint point;
    point.spp = spp_done();
    point.seconds = seconds();
    for (const StageTime& stage : tracer_.stages()) point.gpu_seconds += stage.seconds;
    point.rays = ray_counts(tracer_.counters());
    point.error = estimate_error(film);
    return point;
  }

  void checkpoint() {
    pause_clock(); // reading the film and measuring is not rendering
    const Checkpoint point = measure(read_film(tracer_, settings_.width, settings_.height));
    result_.checkpoints.push_back(point);
    result_.error = point.error;
    if (settings_.target_error > 0.0 && point.error.relative_rms <= settings_.target_error) stop(StopReason::target_error);
    resume_clock();
  }

  void finish() {
    pause_clock();
    const FilmImage film = read_film(tracer_, settings_.width, settings_.height);
    result_.picture = develop(film, settings_.aovs, origin_);
    result_.spp = spp_done(); // complete passes; a pass cut short has given some pixels one more
    const gpu::Queues queues = tracer_.counters();
    result_.nonfinite_samples = queues.nonfinite_samples;
    if (queues.nonfinite_samples > 0) {
      result_.first_nonfinite[0] = queues.first_nonfinite_pixel % settings_.width;
      result_.first_nonfinite[1] = queues.first_nonfinite_pixel / settings_.width;
    }
    const Checkpoint last = measure(film);
    result_.seconds = last.seconds;
    result_.gpu_seconds = last.gpu_seconds;
    result_.rays = last.rays;
    result_.error = last.error;
    const std::uint32_t known = result_.checkpoints.empty() ? 0 : result_.checkpoints.back().spp;
    if (last.spp != known) result_.checkpoints.push_back(last); // ended by time or interrupt
    result_.slope = fit_slope(result_.checkpoints);
    result_.stages = tracer_.stages();
    result_.memory = tracer_.memory();
  }

  RenderSettings settings_;
  const ProgressCallback& progress_;
  PathTracer tracer_;
  Governor governor_;
  glm::dvec3 origin_;
  RenderResult result_;
  Clock::time_point clock_start_{};
  double seconds_before_ = 0.0;
  bool running_ = false, stopped_ = false;
  std::uint32_t sample_ = 0; // the next one
};

} // namespace

RenderResult render(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
                    const ProgressCallback& progress) {
  KernelCompiler kernels(device);
  return render(device, scene, view, settings, progress, kernels);
}

RenderResult render(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
                    const ProgressCallback& progress, KernelCompiler& kernels) {
  return Session(device, scene, view, settings, progress, kernels).run();
}

} // namespace wavepath
