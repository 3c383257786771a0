// What every integrator works on: the scene on the device, the view, the film, the counters of a wave.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "host/render/settings/render_plan.h"
#include "host/render/workspace/device_scene.h"
#include "host/render/workspace/film_target.h"
#include "host/render/workspace/nonfinite.h"
#include "host/scene/staging/view.h"
#include "kernels/base/frame_types.h"

namespace wavepath {

class Workspace {
public:
  // Uploads the scene, unless it is on the device already. `slots`: paths in flight at most. `traversal`: of
  // traversal_of(). Throws Error if the device cannot hold it.
  Workspace(Device& device, const PackedScene& scene, std::uint32_t slots, std::uint32_t traversal,
            std::shared_ptr<const DeviceScene> uploaded = nullptr);

  // Takes up another view and other settings. The integrator adapts the constants in `frame` and calls fit()
  // afterwards.
  void change(const View& view, const RenderPlan& settings);
  // Reserves memory for the film and the list of entries. `features`: kFeature bits of all kernels that may run. Sends
  // `frame` to the device. Returns whether a buffer that kernels are bound to was replaced.
  bool fit(const RenderPlan& settings, gpu::Feature features);
  // Sends `frame` as it was changed. Nothing may be in flight.
  void send_frame();
  // Adaptive renders: the entries of the film (error_probes.h) in the order in which waves visit them. At first that is
  // their own.
  void set_entries(std::vector<std::uint32_t> entries);
  // The entry that waves visit after `index` others, and its pixel and replicate.
  std::uint32_t entry_at(std::uint32_t index) const;
  PixelReplicate pixel_at(std::uint32_t index) const;

  // What every kernel may be bound to; the film's is that of `band`.
  std::vector<Binding> bindings(const FilmBand& band) const;
  std::uint64_t bytes() const { return frame_buffer_.bytes() + counters_.bytes() + entries_buffer_.bytes(); }

  Device& device;
  const PackedScene& scene;
  double upload_seconds = 0.0; // before on_device, whose making sets it
  const std::shared_ptr<const DeviceScene> on_device;
  const std::uint32_t slots;
  gpu::Frame frame{};
  FilmTarget film;

  const Buffer& frame_buffer() const { return frame_buffer_; }
  const Buffer& counters() const { return counters_; }

private:
  Buffer frame_buffer_, counters_, entries_buffer_;
  std::vector<std::uint32_t> entries_;
};

// Numbers and kinds of Workspace::bindings(), without buffers.
std::vector<Binding> workspace_layout();

// One binding set for every band of the film: the workspace's bindings and those of `own`.
std::vector<std::unique_ptr<BindingSet>> bind_bands(const Workspace& workspace, const std::vector<Binding>& own);

// The film of a render.
FilmShape film_shape(const RenderPlan& settings);

// Paths in flight: as many as the render has, within an eighth of the device's memory, one storage buffer, and what a
// dispatch may hold. A CPU gains nothing from more than fill its caches; a GPU needs millions to hide latency.
// `features`: kFeature bits of the scene.
std::uint32_t choose_slots(const DeviceInfo& info, gpu::Feature features, const RenderPlan& settings);

} // namespace wavepath
