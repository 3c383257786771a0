// A decision of the plan: what was to be decided, what was taken, why, and what finding out took.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace wavepath {

// One candidate as its pilot showed it.
struct Trial {
  std::string flags;         // "path", "path --guide": as the command line names it
  double cost = 0.0;         // squared error times work (pilot_runner.h), over that of the first candidate
  double lo = 0.0, hi = 0.0; // 95 % interval of `cost`
  double missing = 0.0;      // fraction of the brightest candidate's light that this one lacks beyond noise
  bool disagrees = false;    // with the first candidate, on light that both find (agreement.h): one of the two is wrong
};

// The picture of a pilot; of no pixels where there was none.
struct PilotPicture {
  std::uint32_t width = 0, height = 0, spp = 0;
};

struct Decision {
  std::string_view what;     // name of the setting
  std::string taken;         // its value, as the command line has it
  std::string why;           // a clause
  double cost = 1.0;         // squared error times work that is expected of it, over that of what a rule would take
  double lo = 1.0, hi = 1.0; // 95 % interval of `cost`; equal where nothing tells
  double seconds = 0.0;      // that its pilots took, compiling and upload included
  double render_seconds = 0.0;
  double fraction = 0.0;       // of the render's paths that its pilots have, as foreseen
  PilotPicture pilot{};        // of each candidate
  bool is_told = false;        // in a line of its own, also without --verbose
  std::vector<Trial> trials{}; // where candidates are several integrators
};

} // namespace wavepath
