// Shows on stderr how far a render is.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "host/base/clock.h"
#include "host/render/render.h"

namespace wavepath {

// One line: how much is done, samples, time spent and left, speed, error. `bar_width` 0 = no bar.
// What is left is the least of what samples, `time_limit` (seconds; 0 = none) and `target_error` (0 = none) say.
std::string progress_text(const Progress& progress, double time_limit, double target_error, int bar_width);

// "3.4 s", "12:05 min" or "2:00:10 h".
std::string duration_text(double seconds);

// Position in a sequence of frames.
struct FramesDone {
  std::uint32_t number = 0;          // of the frame in progress
  std::size_t before = 0, count = 1; // frames rendered before it, and all that are to be
};

// The same of a sequence that has taken so many seconds: the bar and the time left are of all frames.
std::string progress_text(const Progress& progress, const FramesDone& frames, double seconds, double time_limit,
                          double target_error, int bar_width);

class ProgressDisplay {
public:
  ProgressDisplay(bool quiet, double time_limit, double target_error);
  ~ProgressDisplay() { clear(); }
  ProgressDisplay(ProgressDisplay&&) = delete;

  // A bar that is drawn over on a terminal; elsewhere a line, at most every 5 s.
  void show(const Progress& progress);
  // `step` is called whenever there is something to show, before that; it may print after clear().
  void call_meanwhile(std::function<void()> step) { meanwhile_ = std::move(step); }
  // From here on it shows this frame among all.
  void begin_frame(const FramesDone& frames);
  // Leaves the cursor at the start of an empty line.
  void clear();

private:
  bool quiet_, terminal_;
  double time_limit_, target_error_;
  Clock::time_point last_;
  std::function<void()> meanwhile_;
  std::optional<FramesDone> frames_; // of a sequence
  Clock::time_point begun_;          // the first of them
  bool drawn_ = false;
};

} // namespace wavepath
