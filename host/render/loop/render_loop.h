// The one render loop: cuts passes into waves, keeps two of them in flight, governs their length, takes the time, makes
// checkpoints, estimates the error beside the next waves, and ends the render.
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

// Which checkpoints get an estimate of the error: all that the device need not wait for, or that decide; but for the
// last those alone that take little of the time; none.
enum class Estimates { all, cheap, none };

// How a loop is driven: to its end at once, or in steps by a window.
struct LoopPolicy {
  double longest_dispatch = kLongestDispatch; // seconds
  bool by_wave = false;                       // longest_dispatch bounds whole waves, so that step() returns soon
  Estimates estimates = Estimates::all;
  bool clock_is_busy_time = false; // the time between steps does not count
  std::uint32_t least_slots = 0;   // of paths in flight
  std::uint32_t most_slots = ~0u;
  std::uint32_t fixed_wave = 0; // paths of a wave, for measurements; 0 = governed
};

class RenderLoop {
public:
  // Uploads the scene, unless it is on the device already, and begins compiling. `scene`, `kernels` and the hooks'
  // resume state outlive the loop. Throws Error if the device cannot hold it.
  RenderLoop(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
             KernelCompiler& kernels, RenderHooks hooks = {}, const LoopPolicy& policy = {},
             std::shared_ptr<const DeviceScene> uploaded = nullptr);
  ~RenderLoop(); // waits for what is in flight

  // Begins anew with another view and other settings of the same scene. Data on the device is kept where it serves.
  void restart(const View& view, const RenderPlan& settings, TemporalHistory history = TemporalHistory::forget);

  // True if there are kernels to begin with, so that step() will not wait for any.
  bool is_ready() { return integrator_->is_ready(); }
  // Waits for them. Returns the seconds that compiling took.
  double get_ready() { return integrator_->get_ready(); }

  // Hands the device one wave more; where two are in flight, waits for the older one first. False if nothing is left to
  // do.
  bool step();
  bool is_done() const;
  // Waits for all waves in flight.
  void drain() { queue_.drain(); }
  // Takes in estimates of the error that have been finished; all of them with `wait`.
  void collect_estimates(bool wait);
  // The result of a loop that is done.
  RenderResult finish();
  // The result up to the last estimate of the error, after step() or finish() threw that the device is lost. Throws the
  // same where there was no estimate yet.
  RenderResult salvage(const DeviceLost& lost);

  // How far it is. Samples count once their last wave has been handed over.
  std::uint32_t spp() const { return cursor_.sample - settings_.first_sample; }
  bool in_pass() const { return cursor_.pass_samples > 0; }
  double seconds() const;                                 // rendering alone
  double pixel_seconds() const { return pixel_seconds_; } // of one sample of one pixel in the last pass; 0 = unknown
  const std::vector<Checkpoint>& checkpoints() const { return result_.checkpoints; }
  const Totals& totals() const { return queue_.totals; }
  MemoryUse memory() const;
  Film film(); // waits for what is in flight
  const RenderPlan& settings() const { return settings_; }
  const Workspace& workspace() const { return workspace_; }
  const Integrator& integrator() const { return *integrator_; }

private:
  struct Pending { // a checkpoint, or an estimate of the error between two
    Checkpoint point;
    Totals totals;
    std::uint32_t sample = 0; // one past the last that it holds
    bool is_checkpoint = false, measured = false;
    std::shared_ptr<FilmSnapshot> copy; // null: too few samples for an estimate
    std::future<FilmEstimate> estimate;
  };

  bool traces_paths() const { return settings_.integrator->traces_paths; }
  std::uint64_t pixels() const { return workspace_.film.pixels(); }
  std::uint64_t entries() const { return workspace_.film.shape().entries(); } // that a pass covers
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
  double estimate_pixel_seconds_ = 0.0; // of the last one
  std::shared_ptr<const Film> film_;    // as it was when `film_sample_` had been reached
  std::uint32_t film_sample_ = 0;
  std::uint32_t film_next_check_ = 0; // what target_ said then
  std::uint32_t saved_sample_ = 0;    // that the last periodic save had reached
  Checkpoint last_;                   // of that film
  Totals film_totals_;
  RenderResult result_;

  Clock::time_point clock_start_{}, last_save_{}, next_show_{};
  double seconds_before_ = 0.0;
  bool running_ = false;
};

} // namespace wavepath
