// Ends a render at a target error, by looks at the error whose samples do not depend on timing.
#pragma once

#include <cstdint>
#include <vector>

#include "host/film/error.h"

namespace wavepath {

// Schedule of looks. A look is an estimate of the film as it was at a sample (index within a pixel, as in
// RenderCursor). Its result arrives later, while rendering continues; results arrive in the order of the looks.
class Target {
public:
  Target() = default; // no target: all samples are rendered
  // `relative_rms`: the error to reach. `step`: distances between looks are multiples of it. `next_check`: for a
  // resumed render, the value of next_check() in its state.
  Target(double relative_rms, std::uint32_t first_sample, std::uint32_t last_sample, std::uint32_t step,
         std::uint32_t next_check = 0);

  bool is_set() const { return relative_rms_ > 0.0; }
  // Sample of the next look between checkpoints; 0 = none.
  std::uint32_t next_check() const { return next_check_; }
  // Sample that no pass may exceed while the result of a look is unknown: the next look might be due there. 0 = no
  // limit.
  std::uint32_t limit() const { return limit_; }

  // Notes that a look at `sample` has begun, at a film of `spp` samples a pixel.
  void begin(std::uint32_t sample, std::uint32_t spp);
  // Takes the result of the look at `sample`. Returns true if the render ends with that film: its error is small enough
  // and known well enough. Otherwise predicts from `checkpoints` when it may be, and schedules the next look there. The
  // error is that of the whole picture, in which one pixel has hardly any weight. So no pixel stops early because its
  // error seems small by chance.
  bool take(std::uint32_t sample, const Checkpoint& found, const std::vector<Checkpoint>& checkpoints);

private:
  // Sample that lies beyond `sample` by more than `growth` times the samples so far, rounded up to whole steps; at most
  // the last sample.
  std::uint32_t whole_steps_beyond(std::uint32_t sample, double growth) const;

  double relative_rms_ = 0.0; // 0 = none
  std::uint32_t first_sample_ = 0, last_sample_ = 0, step_ = 1;
  std::uint32_t next_check_ = 0, looked_at_ = 0, limit_ = 0;
};

} // namespace wavepath
