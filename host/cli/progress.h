// Shows on stderr how far a render is.
#pragma once

#include <string>

#include "host/base/clock.h"
#include "host/render/render.h"

namespace wavepath {

// One line: how much is done, samples, time spent and left, speed, error. `bar_width` 0 = no bar.
// What is left is the least of what samples, `time_limit` (seconds; 0 = none) and `target_error` (0 = none) say.
std::string progress_text(const Progress& progress, double time_limit, double target_error, int bar_width);

// "3.4 s", "12:05 min" or "2:00:10 h".
std::string duration_text(double seconds);

class ProgressDisplay {
public:
  ProgressDisplay(bool quiet, double time_limit, double target_error);
  ~ProgressDisplay(); // leaves the cursor at the start of an empty line
  ProgressDisplay(ProgressDisplay&&) = delete;

  // A bar that is drawn over on a terminal; elsewhere a line, at most every 5 s.
  void show(const Progress& progress);

private:
  bool quiet_, terminal_;
  double time_limit_, target_error_;
  Clock::time_point last_;
  bool drawn_ = false;
};

} // namespace wavepath
