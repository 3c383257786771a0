// Interface of an integrator at work on a device. IntegratorKind describes an integrator before there is a device.
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

// Use of earlier frames by later ones: a moving camera keeps what an integrator has learned, a cut forgets it.
enum class TemporalHistory { forget, keep };

// Pixels that a pass treats alike: a band of the film, or the pixels of one level within a band in an adaptive render.
// An error probe counts as a pixel.
struct Segment {
  std::size_t band = 0;
  std::uint32_t first_entry = 0, pixel_count = 0; // as gpu::Wave::first_pixel
  int level = 0;
};

// Request for samples that are rendered before the picture's first ones, to decide or train something, and then
// discarded.
struct Pilot {
  std::vector<Segment> segments;
  std::uint32_t samples = 1;
  std::uint32_t seed = 0; // exclusive-ored with the seed of the render
  std::uint32_t first_sample = 0;
  std::uint32_t width = 0, height = 0; // size of its own picture, at most the render's; 0 = the render's
  // Split the samples of every pixel between two replicates, even if the render has probes.
  bool splits_replicates = false;
  bool reuses_paths = true; // pixels may reuse paths, if those of the render do
};

// An integrator on a device. The render loop cuts passes into waves and calls, in this order: change(), get_ready(),
// the pilot's pass and end_pilot() while there is a pilot, then for every pass begin_pass(), record_wave() for all its
// waves, end_pass(). Recorded commands are executed in that order.
class Integrator {
public:
  virtual ~Integrator() = default;

  // Adopts the view and the settings to which the workspace was changed: adapts the constants, begins compiling,
  // reserves memory. Throws Error if the device cannot hold it.
  virtual void change(const View& view, const RenderPlan& settings, TemporalHistory history) = 0;
  // True if the kernels are compiled, so that get_ready() will not wait.
  virtual bool is_ready() = 0;
  // Returns the seconds that compiling took. Throws what compiling threw.
  virtual double get_ready() = 0;

  virtual std::optional<Pilot> pilot() { return std::nullopt; }
  // Called when the pilot's waves have been waited for and nothing is in flight. Returns true if pilot() has another
  // one.
  virtual bool end_pilot() { return false; }

  // Paths in flight of a pixel that gets so many samples in a wave.
  virtual std::uint32_t paths_per_pixel(std::uint32_t samples) const { return samples; }
  // Upper limit for the samples of a pass that begins with `first_sample`.
  virtual std::uint32_t most_samples(std::uint32_t /*first_sample*/) const {
    return 4096; // kernels loop over them; Mesa 22.3 ends loops at 65,535
  }
  // Begins a pass over all pixels, whose first sample is `first_sample`.
  virtual void begin_pass(WaveQueue& queue, std::uint32_t first_sample) = 0;
  // Push constants of a wave: `count` samples from `first_sample` on, of `pixel_count` entries from `first_entry` on.
  // In an adaptive render, entries are counted in the workspace's list of entries.
  virtual gpu::Wave wave(const FilmBand& band, std::uint32_t first_entry, std::uint32_t pixel_count,
                         std::uint32_t first_sample, std::uint32_t count) const;
  // Records the commands of the wave; submits nothing and waits for nothing. `band`: index among the bands of the film.
  virtual void record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) = 0;
  virtual void end_pass(WaveQueue&) {}

  virtual std::uint32_t timed_dispatches() const = 0; // timed dispatches of a wave
  virtual std::uint64_t bytes() const = 0;            // device memory besides the workspace's
  virtual void describe(RenderResult&) const {}       // adds its own entries to the report
};

} // namespace wavepath
