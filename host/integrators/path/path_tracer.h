// The wavefront path tracer on the device: its kernels, queues and film, and the one function that runs a wave.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "host/gpu/commands.h"
#include "host/render/device_scene.h"
#include "host/render/kernel_compiler.h"
#include "host/render/render.h"
#include "host/integrators/hybrid/visibility.h"
#include "host/scene/view.h"

namespace wavepath {

// A run of pixels (in tile order) whose film fits into one buffer of the device.
struct FilmBand {
  std::uint32_t first_pixel = 0, pixel_count = 0;
  Buffer film, aovs; // may have room for more
  std::unique_ptr<BindingSet> bindings;
};

// What the paths in flight live in, and the queues between kernels.
struct PathBuffers {
  Buffer frame, states, media, aovs, rays, hits, shadow_rays, queues, runs;
  Buffer hybrid, gbuffer, signals, seen, jitters; // of the hybrid integrators
  std::uint64_t bytes() const;
};

// Slots and kinds of everything that the kernels are bound to, without buffers.
std::vector<Binding> path_tracer_bindings();

class PathTracer {
public:
  // Has `kernels` compile what this scene needs, uploads the scene and allocates queues for `slots` paths in flight.
  // Throws Error if the device cannot hold them. `kernels` outlives the tracer.
  PathTracer(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
             std::uint32_t slots, KernelCompiler& kernels);

  // Traces samples [first_sample, first_sample + sample_count) of pixels [first_pixel, first_pixel + pixel_count) of a
  // band and adds them to its film. At most `slots` (pixel, sample) pairs. Returns the longest dispatch in seconds. In
  // an adaptive render the pixels are those that have these places in the list of runs, and lie in the band all the
  // same.
  double render_wave(const FilmBand& band, std::uint32_t first_pixel, std::uint32_t pixel_count,
                     std::uint32_t first_sample, std::uint32_t sample_count);

  // Goes on with another view and other settings of the scene that is on the device, which `scene` is: begins compiling what they
  // need, makes room where there is too little, and resets. What was allocated for a larger picture is kept.
  void change(const PackedScene& scene, const View& view, const RenderSettings& settings);

  // Whether there are kernels to begin with, so that render_wave() will not wait.
  bool is_ready() { return !traces_paths_ || kernels_.ready(config_); }

  // Resets, and waits until there are kernels to begin with. Returns the seconds that compiling those took.
  double get_ready();

  void empty_film();
  // Empties the film and sets all counts and times to zero.
  void reset();

  // The runs of kRunPixels pixels that places in a wave stand for, of an adaptive render. At first each stands for
  // itself. A run cut short by the end of the picture comes last in its wave.
  void set_runs(const std::vector<std::uint32_t>& runs);
  void set_seed(std::uint32_t seed);
  // Goes on from what counters(), stages() and nonfinite() said earlier.
  void set_counters(gpu::Queues counters, std::vector<StageTime> stages, const Nonfinite& nonfinite);

  std::vector<FilmBand>& bands() { return bands_; }
  const std::vector<FilmBand>& bands() const { return bands_; }
  std::uint32_t slots() const { return frame_.slot_count; }
  std::uint32_t features() const { return config_.features; }
  bool has_aovs() const { return has_aovs_; }
  const std::vector<StageTime>& stages() const { return stages_; }
  double upload_seconds() const { return upload_seconds_; }
  gpu::Queues counters() const; // totals since reset(), but for those of non-finite samples
  const Nonfinite& nonfinite() const { return nonfinite_; } // since reset()
  MemoryUse memory() const;

private:
  friend class RayReplay; // host/bench
  friend class PathReplay; // host/render/path_replay.h
  friend class Hybrid;     // host/render/hybrid.h

  void begin_kernels(const RenderSettings& settings);
  void allocate(const PackedScene& scene, const RenderSettings& settings);
  bool make_room(Buffer& buffer, std::uint64_t bytes);
  bool make_room_for_paths(const RenderSettings& settings);
  bool make_room_for_film(const RenderSettings& settings);
  bool make_room_for_frames(const PackedScene& scene, const RenderSettings& settings, bool moved_paths);
  void collect_nonfinite(const gpu::Wave& wave);
  void count_time(const std::string& name, double seconds);
  double count_times(const Commands& commands); // by stage; returns the longest

  Device& device_;
  gpu::Frame frame_{};
  KernelCompiler& kernels_;
  KernelConfig config_;        // what this scene needs
  bool traces_paths_ = true;   // otherwise it has no kernels of its own
  std::uint32_t features_ = 0; // and what kernels that may run before those are ready need besides
  GpuScene scene_;
  PathBuffers paths_;
  std::unique_ptr<Visibility> visibility_; // of the hybrid integrators
  glm::uvec3 visibility_made_for_{0};      // width, height, features
  bool has_aovs_ = false;                  // the film has
  std::vector<FilmBand> bands_;
  std::vector<StageTime> stages_;
  Nonfinite nonfinite_;
  std::vector<std::uint32_t> runs_; // of an adaptive render
  double upload_seconds_ = 0.0;
};

// Paths in flight: as many as the render has, within an eighth of the device's memory, one storage buffer, and what a
// dispatch may hold. A CPU gains nothing from more than fill its caches; a GPU needs millions to hide latency.
std::uint32_t choose_slots(const DeviceInfo& info, const PackedScene& scene, const RenderSettings& settings);

RayCounts ray_counts(const gpu::Queues& queues);

// Bytes of path state and queues that one path in flight takes, for the features given.
std::uint64_t bytes_per_slot(std::uint32_t features);

} // namespace wavepath
