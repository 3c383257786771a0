// A decision of the plan: which setting, the value taken, the reason, and the time spent on deciding.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace wavepath {

// What the pilot of one candidate showed.
struct Trial {
  std::string flags;         // integrator and flags, as on the command line: "path", "path --guide"
  double cost = 0.0;         // squared error times work (pilot_runner.h), relative to the first candidate's
  double lo = 0.0, hi = 0.0; // 95 % interval of `cost`
  double missing = 0.0;      // fraction of the brightest candidate's light that this candidate lacks, beyond noise
  // Differs from the first candidate on light that both find: one of them is wrong (agreement.h).
  bool disagrees = false;
};

// Picture size in pixels and samples a pixel of a pilot; all 0 where no pilot was made.
struct PilotPicture {
  std::uint32_t width = 0, height = 0, spp = 0;
};

// Result and expense of the pilots of one decision.
struct PilotOutcome {
  double cost = 1.0;           // predicted squared error times work of the best candidate, relative to the rule's
  double seconds = 0.0;        // wall time, waiting for kernels and upload included
  double render_seconds = 0.0; // part of `seconds` spent rendering
  PilotPicture pilot{};        // size of each candidate's pilot
  double fraction = 0.0;       // ratio of the pilots' paths to the render's
};

struct Decision {
  std::string_view what;     // name of the setting
  std::string taken;         // its value, spelled as on the command line
  std::string why;           // the reason, as a clause
  double cost = 1.0;         // predicted squared error times work, relative to the value that a rule would take
  double lo = 1.0, hi = 1.0; // 95 % interval of `cost`; both equal to it where the interval is unknown
  double seconds = 0.0;      // wall time of the pilots, compiling and upload included
  double render_seconds = 0.0;
  double fraction = 0.0;       // predicted ratio of the pilots' paths to the render's
  PilotPicture pilot{};        // size of each candidate's pilot
  bool is_told = false;        // printed in a line of its own, even without --verbose
  std::vector<Trial> trials{}; // one for each candidate, if integrators were compared

  void add(const PilotOutcome& outcome) {
    cost = lo = hi = outcome.cost;
    seconds = outcome.seconds, render_seconds = outcome.render_seconds;
    fraction = outcome.fraction, pilot = outcome.pilot;
  }
};

} // namespace wavepath
