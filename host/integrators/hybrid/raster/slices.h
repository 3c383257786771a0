// Rasterization in submissions short enough for a driver's watchdog and for what else waits for the device.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "host/gpu/raster.h"
#include "host/render/workspace/wave_queue.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {

// Amount of work in one submission, adapted from frame to frame to the time that the slices of the last one took.
class SliceLength {
public:
  // The first size is a guess; units are the caller's.
  explicit SliceLength(std::uint64_t first) : size_(first) {}

  // Work in each slice of the frame that begins.
  std::uint64_t next_frame();
  void note(double seconds) {
    seconds_ += seconds;
    ++count_;
  }

private:
  std::uint64_t size_;
  double seconds_ = 0.0; // seconds of the finished pieces of the last frame
  std::uint64_t count_ = 0;
};

// A raster pass that is drawn in slices. Everything that it refers to must outlive the submitted work.
struct SlicedPass {
  RasterTarget* target = nullptr;
  const RasterPipeline* pipeline = nullptr;
  const BindingSet* bindings = nullptr;
  const void* push = nullptr; // copied when it is recorded
  std::uint32_t layer = 0;
  const char* stage = "raster";    // stage that the time is counted under
  std::uint32_t clear = kClearAll; // attachments that the first slice clears; the others keep their contents
};

// Submits the draws in slices of at most `triangles`; `before` is recorded in front of the first one, `after` behind
// the last. There is at least one slice. `done`: called with the seconds of each.
void draw_in_slices(WaveQueue& queue, const SlicedPass& pass, std::span<const Draw> draws, std::uint64_t triangles,
                    const std::function<void(Commands&)>& before, const std::function<void(Commands&)>& after,
                    const std::function<void(double)>& done);

} // namespace wavepath
