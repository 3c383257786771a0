#include "host/render/multi_device/several_devices.h"

#include <algorithm>
#include <atomic>
#include <deque>
#include <future>
#include <memory>
#include <numeric>

#include "host/base/clock.h"
#include "host/base/error.h"
#include "host/film/film.h"
#include "host/gpu/device.h"
#include "host/render/loop/render_loop.h"
#include "host/render/multi_device/deal.h"
#include "host/render/pilot_picture.h"
#include "host/render/settings/probing.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kGrowth = 3;       // samples of a round over those of all before
constexpr std::uint32_t kPilotSide = 64;   // pixels of the pilot by which bits are compared
constexpr std::uint32_t kPilotSamples = 2; // and its samples
constexpr std::uint32_t kFewest = 16;      // samples, before an estimate of the error may end a render
constexpr double kLook = 0.1;              // seconds between looks at how far devices are

// Adds what another device, or another range, came to.
void add(RenderResult& sum, const RenderResult& part) {
  sum.rays.camera += part.rays.camera;
  sum.rays.bounce += part.rays.bounce;
  sum.rays.shadow += part.rays.shadow;
  sum.rays.occlusion += part.rays.occlusion;
  sum.gpu_seconds += part.gpu_seconds;
  sum.even &= part.even;
  if (part.reflections) {
    if (!sum.reflections) sum.reflections.emplace();
    sum.reflections->asked += part.reflections->asked;
    sum.reflections->answered += part.reflections->answered;
  }
  for (std::size_t i = 0; i < sum.nonfinite.by_maker.size(); ++i)
    sum.nonfinite.by_maker[i] += part.nonfinite.by_maker[i];
  if (part.nonfinite.first && (!sum.nonfinite.first || *part.nonfinite.first < *sum.nonfinite.first))
    sum.nonfinite.first = part.nonfinite.first;
  for (const StageTime& stage : part.stages) {
    const auto found = std::ranges::find(sum.stages, stage.name, &StageTime::name);
    if (found == sum.stages.end())
      sum.stages.push_back(stage);
    else
      found->seconds += stage.seconds, found->dispatches += stage.dispatches;
  }
}

// A device with its copy of the scene, which renders one range after another.
class Worker {
public:
  Worker(const RenderingDevice& on, const PackedScene& scene, const View& view, const RenderPlan& settings,
         const std::atomic<bool>& stopped)
      : on_(on), scene_(scene), view_(view), settings_(settings), stopped_(stopped) {
    work.name = on.device->info().name;
    work.driver = on.device->info().driver;
  }

  // Uploads and compiles. Returns the film of the pilot.
  std::shared_ptr<const Film> begin() {
    RenderHooks hooks;
    hooks.progress = [this](const Progress& progress) {
      samples_done = progress.spp_done;
      return !stopped_;
    };
    const LoopPolicy policy{.estimates = Estimates::none};
    loop_ = std::make_unique<RenderLoop>(*on_.device, scene_, view_, settings_, *on_.kernels, hooks, policy);
    compile_seconds = loop_->get_ready();
    const RenderPlan small = pilot_settings(settings_, kPilotSide, kPilotSamples);
    loop_->restart(view_, small);
    RenderResult pilot = run();
    speed = speed_of(pilot, kPilotSamples, small);
    work.seconds = 0.0, work.rays = 0; // of the picture alone
    return pilot.film;
  }

  // Throws DeviceLost.
  RenderResult render(const SampleRange& range, double time_limit) {
    RenderPlan settings = settings_;
    settings.first_sample = range.first;
    settings.last_sample = range.end;
    settings.time_limit = time_limit;
    loop_->restart(view_, settings);
    RenderResult result = run();
    speed = speed_of(result, range.end - range.first, settings);
    return result;
  }

  void lose() {
    work.lost = true;
    loop_.reset();
  }

  const PackedScene& scene() const { return scene_; }

  DeviceWork work;
  double speed = 0.0; // samples of every pixel a second
  double compile_seconds = 0.0;
  std::atomic<std::uint32_t> samples_done = 0; // of the range

private:
  RenderResult run() {
    samples_done = 0;
    while (loop_->step()) {
    }
    RenderResult result = loop_->finish();
    work.seconds += result.seconds;
    work.rays += result.rays.total();
    return result;
  }

  double speed_of(const RenderResult& result, std::uint32_t samples, const RenderPlan& settings) const {
    const double pixels = static_cast<double>(settings.width) * settings.height;
    const double all = static_cast<double>(settings_.width) * settings_.height;
    return samples * (pixels / all) / std::max(result.seconds, 1e-6);
  }

  RenderingDevice on_;
  const PackedScene& scene_;
  const View& view_;
  RenderPlan settings_;
  const std::atomic<bool>& stopped_;
  std::unique_ptr<RenderLoop> loop_;
};

// Work of a device in a round, and its result.
struct Task {
  Worker* worker = nullptr;
  SampleRange range;
  std::future<RenderResult> result;
};

class MultiDeviceRender {
public:
  MultiDeviceRender(std::span<const RenderingDevice> devices, const PackedScene& scene, const View& view,
                    const RenderPlan& settings, const RenderHooks& hooks)
      : settings_(settings), hooks_(hooks), origin_(scene.origin) {
    RenderPlan part = settings;
    if (part.sample_total == 0) part.sample_total = settings.last_sample;
    part.target_error = part.time_limit = 0.0;
    for (const RenderingDevice& device : devices)
      workers_.push_back(std::make_unique<Worker>(device, scene, view, part, stopped_));
    left_.push_back({settings.first_sample, settings.last_sample});
  }

  MultiDeviceResult run() {
    begin();
    while (!left_.empty() && !stopped_) {
      render_round();
      if (film_ && judge()) return finish();
    }
    StopReason& stop = result_.result.stop;
    if (stopped_ && !left_.empty() && stop == StopReason::samples) stop = StopReason::interrupted;
    return finish();
  }

private:
  std::uint32_t planned() const { return settings_.last_sample - settings_.first_sample; }

  void begin() {
    std::vector<std::future<std::shared_ptr<const Film>>> pilots;
    for (const auto& worker : workers_)
      pilots.push_back(std::async(std::launch::async, [&worker] { return worker->begin(); }));
    std::shared_ptr<const Film> first;
    std::exception_ptr lost;
    for (std::size_t i = 0; i < pilots.size(); ++i) try {
        const std::shared_ptr<const Film> film = pilots[i].get();
        if (!first) first = film;
        result_.bits_agree &= *film == *first;
        result_.result.compile_seconds = std::max(result_.result.compile_seconds, workers_[i]->compile_seconds);
      } catch (const DeviceLost&) {
        lost = std::current_exception();
        workers_[i]->lose();
      }
    if (!first) std::rethrow_exception(lost);
  }

  // The next `count` samples of those that are left.
  std::vector<SampleRange> take(std::uint32_t count) {
    std::vector<SampleRange> taken;
    while (count > 0 && !left_.empty()) {
      SampleRange& next = left_.front();
      const std::uint32_t size = std::min(count, next.end - next.first);
      taken.push_back({next.first, next.first + size});
      next.first += size;
      count -= size;
      if (next.first == next.end) left_.pop_front();
    }
    return taken;
  }

  // Samples of the next round. Towards a target no more than are foreseen to be needed; of guided renders all, because
  // every range begins with the pilot.
  std::uint32_t next_count() const {
    if (settings_.target_error == 0.0) return settings_.guide ? planned() : done_ * kGrowth;
    if (!has_estimate(done_, result_.result.error)) return done_;
    const double growth = growth_for(result_.result.error.relative_rms / settings_.target_error, result_.result.slope);
    return static_cast<std::uint32_t>(std::clamp(growth - 1.0, 0.0, 1.0) * done_);
  }

  void render_round() {
    std::vector<Worker*> alive;
    std::vector<double> speeds;
    for (const auto& worker : workers_)
      if (!worker->work.lost) alive.push_back(worker.get()), speeds.push_back(worker->speed);
    std::uint32_t waiting = 0;
    for (const SampleRange& range : left_) waiting += range.end - range.first;
    const auto least = static_cast<std::uint32_t>(alive.size());
    const std::uint32_t count = std::min(waiting, std::max(next_count(), least));
    const std::vector<std::uint32_t> counts = deal(count, speeds);
    const Clock::time_point start = Clock::now();
    std::vector<Task> tasks;
    std::vector<std::vector<SampleRange>> more; // that a worker takes after its first
    for (std::size_t i = 0; i < alive.size(); ++i)
      for (const SampleRange& range : take(counts[i])) tasks.push_back({alive[i], range, {}});
    // One after another on each device.
    for (Task& task : tasks)
      task.result = std::async(std::launch::deferred, [this, &task, start] {
        const double left = settings_.time_limit - seconds_ - seconds_since(start);
        return task.worker->render(task.range, settings_.time_limit > 0.0 ? std::max(left, 1e-3) : 0.0);
      });
    std::vector<std::future<void>> threads;
    for (Worker* worker : alive)
      threads.push_back(std::async(std::launch::async, [worker, &tasks] {
        for (Task& task : tasks)
          if (task.worker == worker) task.result.wait();
      }));
    for (std::future<void>& thread : threads)
      while (thread.wait_for(std::chrono::duration<double>(kLook)) != std::future_status::ready)
        tell(seconds_ + seconds_since(start), alive);
    seconds_ += seconds_since(start);
    for (Task& task : tasks) take_in(task);
    std::ranges::sort(left_, {}, &SampleRange::first);
    const bool none = std::ranges::all_of(workers_, [](const auto& worker) { return worker->work.lost; });
    if (none && lost_) {
      if (!film_) std::rethrow_exception(lost_);
      result_.result.stop = StopReason::device_lost;
      stopped_ = true;
    }
  }

  void take_in(Task& task) {
    try {
      const RenderResult part = task.result.get();
      task.worker->work.ranges.push_back({task.range.first, task.range.first + part.spp});
      add(result_.result, part);
      if (result_.result.memory.total() == 0) describe(part);
      if (film_)
        join(*film_, *part.film);
      else
        film_ = std::make_shared<Film>(*part.film);
      done_ += part.spp;
      task.worker->samples_done = 0;
      if (part.stop == StopReason::time) result_.result.stop = StopReason::time, stopped_ = true;
      if (part.stop == StopReason::interrupted) result_.result.stop = StopReason::interrupted;
    } catch (const DeviceLost&) {
      lost_ = std::current_exception();
      task.worker->lose();
      left_.push_back(task.range);
    }
  }

  // Copies facts about scene and integrator that are the same for every device.
  void describe(const RenderResult& part) {
    RenderResult& all = result_.result;
    all.upload_seconds = part.upload_seconds;
    all.by_query = part.by_query;
    all.first_pixel_seconds = part.first_pixel_seconds;
    all.memory = part.memory;
    all.light_training = part.light_training;
    all.ambient = part.ambient;
    all.guide = part.guide;
    all.merging = part.merging;
    all.radiosity = part.radiosity;
    all.shadows = part.shadows;
    all.occlusion = part.occlusion;
    all.antialias = part.antialias;
  }

  void tell(double seconds, const std::vector<Worker*>& workers) {
    if (!hooks_.progress) return;
    Progress progress;
    progress.spp_done = done_;
    for (const Worker* worker : workers) progress.spp_done += worker->samples_done;
    progress.spp_planned = planned();
    progress.fraction = static_cast<double>(progress.spp_done) / planned();
    progress.seconds = seconds;
    if (seconds_ > 0.0) progress.mrays_per_second = 1e-6 * static_cast<double>(result_.result.rays.total()) / seconds_;
    progress.error = result_.result.error;
    progress.slope = result_.result.slope;
    if (!hooks_.progress(progress)) stopped_ = true;
  }

  // A checkpoint after each round. Whether the target is reached.
  bool judge() {
    RenderResult& all = result_.result;
    const Clock::time_point start = Clock::now();
    all.error = estimate_error(*film_);
    all.checkpoints.push_back({done_, seconds_, all.gpu_seconds, all.rays, all.error});
    all.slope = fit_slope(all.checkpoints, Against::seconds);
    if (hooks_.checkpoint)
      hooks_.checkpoint(all.checkpoints.back(), develop(*film_, settings_.aovs, origin_, settings_.group_names));
    all.estimate_seconds += seconds_since(start);
    if (hooks_.show) hooks_.show(develop(*film_, settings_.aovs, origin_, settings_.group_names));
    if (hooks_.publish && done_ < planned() && seconds_since(last_publish_) >= hooks_.publish_interval) {
      RenderResult interrupted = so_far();
      interrupted.stop = StopReason::interrupted;
      hooks_.publish(interrupted);
      last_publish_ = Clock::now();
    }
    const bool reached = settings_.target_error > 0.0 && done_ >= kFewest && has_estimate(done_, all.error) &&
                         all.error.relative_rms <= settings_.target_error;
    if (reached) all.stop = StopReason::target_error;
    return reached;
  }

  RenderResult so_far() const {
    RenderResult all = result_.result;
    all.film = std::make_shared<const Film>(*film_);
    all.picture = develop(*film_, settings_.aovs, origin_, settings_.group_names);
    all.spp = done_;
    all.seconds = seconds_;
    all.even &= has_no_holes();
    return all;
  }

  MultiDeviceResult finish() {
    if (!film_) throw Error("--devices", "the render was stopped before its first sample", "let it run");
    result_.result = so_far();
    for (const auto& worker : workers_) {
      std::ranges::sort(worker->work.ranges, {}, &SampleRange::first);
      result_.device_work.push_back(worker->work);
    }
    return std::move(result_);
  }

  // Samples that were left, by a stop or a lost device, may lie between others.
  bool has_no_holes() const {
    std::vector<SampleRange> ranges;
    for (const auto& worker : workers_)
      ranges.insert(ranges.end(), worker->work.ranges.begin(), worker->work.ranges.end());
    std::ranges::sort(ranges, {}, &SampleRange::first);
    std::uint32_t next = settings_.first_sample;
    for (const SampleRange& range : ranges) {
      if (range.first == range.end) continue;
      if (range.first != next) return false;
      next = range.end;
    }
    return true;
  }

  RenderPlan settings_;
  const RenderHooks& hooks_;
  glm::dvec3 origin_;
  std::atomic<bool> stopped_ = false;
  std::vector<std::unique_ptr<Worker>> workers_;
  std::deque<SampleRange> left_;
  std::shared_ptr<Film> film_;
  std::uint32_t done_ = 0; // samples of every pixel
  double seconds_ = 0.0;
  Clock::time_point last_publish_ = Clock::now();
  std::exception_ptr lost_;
  MultiDeviceResult result_;
};

} // namespace

std::uint32_t DeviceWork::samples() const {
  std::uint32_t sum = 0;
  for (const SampleRange& range : ranges) sum += range.end - range.first;
  return sum;
}

MultiDeviceResult render_by_several(std::span<const RenderingDevice> devices, const PackedScene& scene,
                                    const View& view, const RenderPlan& settings, const RenderHooks& hooks) {
  return MultiDeviceRender(devices, scene, view, settings, hooks).run();
}

} // namespace wavepath
