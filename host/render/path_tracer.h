// The wavefront path tracer on the device: its kernels, queues and film, and the one function that runs a wave.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "host/gpu/commands.h"
#include "host/render/gpu_scene.h"
#include "host/render/render.h"
#include "host/scene/view.h"

namespace wavepath {

// A run of pixels (in tile order) whose film fits into one buffer of the device.
struct FilmBand {
  std::uint32_t first_pixel = 0, pixel_count = 0;
  Buffer film, aovs;
  std::unique_ptr<BindingSet> bindings;
};

// The kernels, in the order of PathTracer::stages().
enum Stage : std::size_t { generate, advance, extend, shade, connect, accumulate, stage_count };

class PathTracer {
public:
  // Uploads the scene, compiles the kernels and allocates queues for `slots` paths in flight. Throws Error if the device
  // cannot hold them.
  PathTracer(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
             std::uint32_t slots);

  // Traces samples [first_sample, first_sample + sample_count) of pixels [first_pixel, first_pixel + pixel_count) of a band
  // and adds them to its film. At most `slots` (pixel, sample) pairs. Returns the longest dispatch in seconds.
  double render_wave(const FilmBand& band, std::uint32_t first_pixel, std::uint32_t pixel_count,
                     std::uint32_t first_sample, std::uint32_t sample_count);

  // Runs every kernel once, so that drivers that compile at the first dispatch have done so, and resets.
  void warm_up();

  // Empties the film and sets all counts and times to zero.
  void reset();

  const std::vector<FilmBand>& bands() const { return bands_; }
  std::uint32_t slots() const { return frame_.slot_count; }
  std::uint32_t features() const { return features_; }
  const std::vector<StageTime>& stages() const { return stages_; }
  double upload_seconds() const { return upload_seconds_; }
  gpu::Queues counters() const; // totals since reset()
  MemoryUse memory() const;

private:
  friend class RayReplay; // host/bench

  void allocate(Device& device, const RenderSettings& settings);
  void create_kernels(Device& device, const RenderSettings& settings, std::uint32_t stack_size);

  Device& device_;
  gpu::Frame frame_{};
  std::uint32_t features_ = 0;
  GpuScene scene_;
  Buffer frame_buffer_, paths_, path_media_, path_aovs_, rays_, hits_, shadow_rays_, queues_;
  std::vector<FilmBand> bands_;
  std::vector<Kernel> kernels_; // in the order of Stage
  std::vector<StageTime> stages_;
  double upload_seconds_ = 0.0;
};

// Paths in flight: as many as the render has, within an eighth of the device's memory, one storage buffer, and what a
// dispatch may hold. A CPU gains nothing from more than fill its caches; a GPU needs millions to hide latency.
std::uint32_t choose_slots(const DeviceInfo& info, const PackedScene& scene, const RenderSettings& settings);

RayCounts ray_counts(const gpu::Queues& queues);

// Bytes of path state and queues that one path in flight takes, for the features given.
std::uint64_t bytes_per_slot(std::uint32_t features);

} // namespace wavepath
