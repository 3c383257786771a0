// The render loop, the only one: cuts passes into waves, keeps two of them in flight, governs their length, measures
// the time, makes checkpoints, estimates the error during the next waves, and ends the render.
#pragma once

#include <cstdint>
#include <deque>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "host/base/clock.h"
#include "host/base/error.h"
#include "host/film/film.h"
#include "host/render/loop/film_estimates.h"
#include "host/render/loop/governor.h"
#include "host/render/loop/hooks.h"
#include "host/render/loop/integrator.h"
#include "host/render/loop/render_result.h"
#include "host/render/loop/render_state.h"
#include "host/render/loop/target.h"
#include "host/render/workspace/wave_queue.h"
#include "host/render/workspace/workspace.h"

namespace wavepath {

// Checkpoints that get an estimate of the error. all: every one for which the device need not wait, or that decides
// something. cheap: the last one, and those that take little of the time. none.
enum class Estimates { all, cheap, none };

// Policy of a loop: run to the end at once, or stepped by a window.
struct LoopPolicy {
  double longest_dispatch = kLongestDispatch; // seconds
  bool by_wave = false;                       // longest_dispatch limits whole waves, so that step() returns soon
  Estimates estimates = Estimates::all;
  bool clock_is_busy_time = false; // the clock counts only the time that the device is busy, not the time between steps
  std::uint32_t least_slots = 0;   // limits of paths in flight
  std::uint32_t most_slots = ~0u;
  std::uint32_t fixed_wave = 0; // paths of a wave, for measurements; 0 = governed
};

class RenderLoop {
public:
  // Uploads the scene unless `uploaded` holds it, and begins compiling. `scene`, `kernels` and the state in
  // hooks.resume must outlive the loop. Throws Error if the device cannot hold the scene.
  RenderLoop(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
             KernelCompiler& kernels, RenderHooks hooks = {}, const LoopPolicy& policy = {},
             std::shared_ptr<const DeviceScene> uploaded = nullptr);
  ~RenderLoop(); // waits for what is in flight

  // Starts over with another view and other settings of the same scene. Reuses data on the device where possible.
  void restart(const View& view, const RenderPlan& settings, TemporalHistory history = TemporalHistory::forget);

  // The same with other hooks, for the next render of the same scene.
  void restart(const View& view, const RenderPlan& settings, RenderHooks hooks);
  // True if the loop has the room that these settings ask for, and its scene on the device is as they need it.
  bool can_render(const RenderPlan& settings) const;
  void forget_hooks() { hooks_ = {}; } // what they refer to may go

  // True if enough kernels are compiled that step() will not wait for any.
  bool is_ready() { return integrator_->is_ready(); }
  // Waits for kernels. Returns the seconds that compiling took.
  double get_ready() { return integrator_->get_ready(); }

  // Submits one more wave; if two are in flight, waits for the older one first. Returns false if no work is left.
  bool step();
  bool is_done() const;
  // Waits for all waves in flight.
  void drain() { queue_.drain(); }
  // Takes in finished estimates of the error; with `wait`, waits for all of them.
  void collect_estimates(bool wait);
  // Result of a loop that is done.
  RenderResult finish();
  // Result up to the last estimate of the error, for use after step() or finish() threw DeviceLost. Throws `lost` again
  // if there is no estimate yet.
  RenderResult salvage(const DeviceLost& lost);

  // Samples a pixel so far. A sample counts when its last wave has been submitted.
  std::uint32_t spp() const { return cursor_.sample - settings_.first_sample; }
  bool in_pass() const { return cursor_.pass_samples > 0; }
  double seconds() const;                                 // of rendering alone
  double pixel_seconds() const { return pixel_seconds_; } // for one sample of one pixel in the last pass; 0 = unknown
  const std::vector<Checkpoint>& checkpoints() const { return result_.checkpoints; }
  const Totals& totals() const { return queue_.totals; }
  MemoryUse memory() const;
  Film film(); // waits for what is in flight
  const RenderPlan& settings() const { return settings_; }
  const Workspace& workspace() const { return workspace_; }
  const Integrator& integrator() const { return *integrator_; }

private:
  struct Pending { // a checkpoint, or an estimate between two checkpoints
    Checkpoint point;
    Totals totals;
    std::uint32_t sample = 0; // end of the range of samples that it holds
    bool is_checkpoint = false, measured = false;
    std::shared_ptr<FilmSnapshot> copy; // null: too few samples for an estimate
    std::future<FilmEstimate> estimate;
  };

  bool traces_paths() const { return settings_.integrator->traces_paths; }
  std::uint64_t pixels() const { return workspace_.film.pixels(); }
  std::uint64_t whole_pixels() const { return std::uint64_t{settings_.width} * settings_.height; }
  // What the picture shows of a film that kernels filled.
  std::shared_ptr<const Film> of_picture(std::shared_ptr<const Film> film) const;
  std::uint64_t entries() const { return workspace_.film.shape().entries(); } // entries of the film that a pass covers
  std::uint32_t planned() const { return settings_.last_sample - settings_.first_sample; }
  std::uint32_t samples_per_pixel() const;
  void pause_clock();
  void resume_clock();
  void stop(StopReason reason);

  void abandon();
  void begin();
  void restore(const RenderState& state);
  void explore(const Pilot& pilot);
  void adapt_levels();
  void use_levels(const std::vector<std::int8_t>& levels);
  std::uint32_t pass_end() const;
  std::uint32_t sample_capacity() const;
  std::uint32_t fitting(const Segment& segment, std::uint32_t done, std::uint32_t count, std::uint32_t slots) const;
  gpu::Wave wave_of(const Segment& segment, std::uint32_t done, std::uint32_t taken, std::uint32_t first,
                    std::uint32_t count) const;
  void submit_wave(std::size_t band, const gpu::Wave& wave, std::uint32_t slots);
  void submit_next_wave();
  bool is_pass_submitted() const { return cursor_.segment >= segments_.size(); }
  bool is_first_pass_complete() const;
  void end_pass();
  Progress progress() const;
  void report_progress();

  bool is_checkpoint() const;
  bool is_check() const { return cursor_.sample == target_.next_check(); }
  bool is_look_due() const;
  bool pays() const;
  bool gets_estimate() const;
  std::size_t copies_in_use() const;
  void checkpoint();
  void measure(Pending& pending);
  void take_in_first();
  void stop_at(const Pending& pending);
  bool has_film() const { return film_ && film_sample_ == cursor_.sample && !in_pass(); }
  bool is_save_due() const;
  void save();
  bool is_publish_due() const;
  void publish();
  bool is_show_due() const;
  void show();
  RenderState state();

  RenderPlan settings_;
  RenderHooks hooks_;
  LoopPolicy policy_;
  KernelCompiler& kernels_;
  Workspace workspace_;
  WaveQueue queue_;
  const IntegratorKind* kind_ = nullptr;
  std::unique_ptr<Integrator> integrator_;
  Governor governor_;
  std::vector<Segment> segments_;
  std::vector<std::int8_t> levels_;
  double mean_factor_ = 1.0;
  RenderCursor cursor_;
  bool begun_ = false, exploring_ = false, abandoning_ = false, stopped_ = false;
  double pixel_seconds_ = 0.0, pass_began_busy_ = 0.0;

  std::deque<Pending> pending_;
  FilmEstimates estimates_;
  const bool estimates_at_once_;
  Target target_;
  double estimate_pixel_seconds_ = 0.0; // duration of the last estimate, for each pixel
  std::shared_ptr<const Film> film_;    // the film as of `film_sample_`
  std::uint32_t film_sample_ = 0;
  std::uint32_t film_next_check_ = 0; // target_.next_check() at that time
  std::uint32_t saved_sample_ = 0;    // sample of the last periodic save
  Checkpoint last_;                   // checkpoint of film_
  Totals film_totals_;
  RenderResult result_;

  Clock::time_point clock_start_{}, last_save_{}, last_publish_{}, next_show_{};
  double seconds_before_ = 0.0;
  bool running_ = false;
};

} // namespace wavepath
