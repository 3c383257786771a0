// The error at which a render shall stop: when to look at the error, such that the stop does not depend on timing.
#pragma once

#include <cstdint>
#include <vector>

#include "host/film/error.h"

namespace wavepath {

// Samples are indices of one pixel, as in RenderCursor. A look is an estimate of the film as it was at a sample; what
// it found is told later, in the order of the looks, while rendering goes on.
class Target {
public:
  Target() = default; // none: a render of all its samples
  // `step`: looks are apart by a multiple of it. `next_check`: of a resumed render, what next_check() said.
  Target(double relative_rms, std::uint32_t first_sample, std::uint32_t last_sample, std::uint32_t step,
         std::uint32_t next_check = 0);

  bool is_set() const { return relative_rms_ > 0.0; }
  // Sample at which to look, besides the checkpoints; 0 = none.
  std::uint32_t next_check() const { return next_check_; }
  // While a look that may end the render is not known, no pass goes beyond this sample: the one at which the next look
  // might be due. 0 = no bound.
  std::uint32_t limit() const { return limit_; }

  // A look at `sample` has begun, at a film of `spp` samples a pixel.
  void begin(std::uint32_t sample, std::uint32_t spp);
  // Takes the estimate at `sample`. Returns true if the render ends with that film: its error is small enough, and
  // known well enough. Otherwise predicts by `checkpoints` where it may be, to look again there. The rule is about the
  // error of the whole picture, in which one pixel weighs next to nothing: no pixel stops early because its error seems
  // small by chance.
  bool take(std::uint32_t sample, const Checkpoint& found, const std::vector<Checkpoint>& checkpoints);

private:
  // The sample that lies, in whole steps, more than `growth` of the samples so far beyond `sample`, or the last that
  // has an index.
  std::uint32_t whole_steps_beyond(std::uint32_t sample, double growth) const;

  double relative_rms_ = 0.0; // 0 = none
  std::uint32_t first_sample_ = 0, last_sample_ = 0, step_ = 1;
  std::uint32_t next_check_ = 0, looked_at_ = 0, limit_ = 0;
};

} // namespace wavepath
