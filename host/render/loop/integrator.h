// The interface of integrators at work on a device. An IntegratorKind tells of one before that.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host/render/settings/integrator_kind.h"
#include "kernels/base/frame_types.h"

namespace wavepath {

class Commands;
class WaveQueue;
struct FilmBand;
struct View;

// Use of earlier frames by coming ones: a camera in motion keeps what an integrator learned, a cut forgets it.
enum class TemporalHistory { forget, keep };

// Pixels that a pass treats alike: a band of the film, or in an adaptive render those of one level within a band. An
// error probe counts as a pixel.
struct Segment {
  std::size_t band = 0;
  std::uint32_t first_entry = 0, pixel_count = 0; // as gpu::Wave::first_pixel
  int level = 0;
};

// Samples that are rendered before the first ones of the picture, to decide something or to train, and discarded.
struct Pilot {
  std::vector<Segment> segments;
  std::uint32_t samples = 1;
  std::uint32_t seed = 0; // by exclusive or with the render's own
  std::uint32_t first_sample = 0;
  std::uint32_t width = 0, height = 0; // of a picture of its own, not larger than the render's; 0 = the render's
  bool splits_replicates = false;      // samples between two replicates of every pixel, even if the render has probes
  bool reuses_paths = true;            // where pixels of the render do
};

// An integrator on a device. The render loop cuts passes into waves and calls, in this order: change(), get_ready(),
// the pilot's pass and end_pilot() while there is a pilot, then for every pass begin_pass(), record_wave() for all its
// waves, end_pass(). Recorded commands are executed in that order.
class Integrator {
public:
  virtual ~Integrator() = default;

  // Takes up the view and the settings that the workspace was changed to: adapts the constants, begins compiling,
  // reserves memory. Throws Error if the device cannot hold it.
  virtual void change(const View& view, const RenderPlan& settings, TemporalHistory history) = 0;
  // True if the kernels are compiled, so that get_ready() will not wait.
  virtual bool is_ready() = 0;
  // Returns the seconds that compiling took. Throws what compiling threw.
  virtual double get_ready() = 0;

  virtual std::optional<Pilot> pilot() { return std::nullopt; }
  // After the pilot's waves were rendered and waited for. Nothing is in flight.
  // Returns whether to go on with another pilot().
  virtual bool end_pilot() { return false; }

  // Paths that a pixel of a wave counts for, when it gets so many samples.
  virtual std::uint32_t paths_per_pixel(std::uint32_t samples) const { return samples; }
  // Samples at most of a pass that begins with sample `first_sample`.
  virtual std::uint32_t most_samples(std::uint32_t /*first_sample*/) const {
    return 4096; // kernels loop over them; Mesa 22.3 ends loops at 65,535
  }
  // A pass covers all pixels, beginning with sample `first_sample`.
  virtual void begin_pass(WaveQueue& queue, std::uint32_t first_sample) = 0;
  // Push constants of a wave's kernels: `count` samples from `first_sample` on of pixels at entries from `first_entry`
  // on. An adaptive render then tells them where in its list these stand instead.
  virtual gpu::Wave wave(const FilmBand& band, std::uint32_t first_entry, std::uint32_t pixel_count,
                         std::uint32_t first_sample, std::uint32_t count) const;
  // Records the wave, and nothing else: submits nothing and waits for nothing. `band`: its index among the film's.
  virtual void record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) = 0;
  virtual void end_pass(WaveQueue&) {}

  virtual std::uint32_t timed_dispatches() const = 0; // of a wave
  virtual std::uint64_t bytes() const = 0;            // of device memory besides the workspace's
  virtual void describe(RenderResult&) const {}       // what the report says of its own
};

} // namespace wavepath
