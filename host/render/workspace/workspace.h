// Workspace of an integrator: the scene on the device, the view, the film, the counters of a wave.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "host/render/settings/crop.h"
#include "host/render/settings/render_plan.h"
#include "host/render/workspace/device_scene.h"
#include "host/render/workspace/film_target.h"
#include "host/render/workspace/group_buffers.h"
#include "host/render/workspace/nonfinite.h"
#include "host/scene/staging/view.h"
#include "kernels/base/frame_types.h"

namespace wavepath {

class Workspace {
public:
  // Uploads the scene unless `uploaded` holds it. `slots`: limit of paths in flight. `traversal`: value of
  // traversal_of(). Throws Error if the device cannot hold the scene.
  Workspace(Device& device, const PackedScene& scene, std::uint32_t slots, std::uint32_t traversal,
            std::shared_ptr<const DeviceScene> uploaded = nullptr);

  // Adopts another view and other settings. The integrator then adapts the constants in `frame` and calls fit().
  void change(const View& view, const RenderPlan& settings);
  // Reserves memory for the film and the list of entries, and sends `frame` to the device. `features`: kFeature bits of
  // all kernels that may run. Returns true if a buffer that kernels are bound to was replaced.
  bool fit(const RenderPlan& settings, gpu::Feature features);
  // Sends `frame` to the device after a change. Nothing may be in flight.
  void send_frame();
  // Sets the order in which waves of an adaptive render visit the entries of the film (error_probes.h). Initially it is
  // ascending.
  void set_entries(std::vector<std::uint32_t> entries);
  // The entry at position `index` of that order, and its pixel and replicate.
  std::uint32_t entry_at(std::uint32_t index) const;
  PixelReplicate pixel_at(std::uint32_t index) const;

  // Bindings that every kernel may use, with the film of `band`.
  std::vector<Binding> bindings(const FilmBand& band) const;
  std::uint64_t bytes() const {
    return frame_buffer_.bytes() + counters_.bytes() + entries_buffer_.bytes() + groups_.table.bytes() +
           groups_.paths.bytes();
  }

  Device& device;
  const PackedScene& scene;
  double upload_seconds = 0.0; // declared before on_device, whose initialization sets it
  const std::shared_ptr<const DeviceScene> on_device;
  const std::uint32_t slots;
  gpu::Frame frame{};
  FilmTarget film;

  const Buffer& frame_buffer() const { return frame_buffer_; }
  const Buffer& counters() const { return counters_; }

private:
  Buffer frame_buffer_, counters_, entries_buffer_;
  GroupBuffers groups_;
  std::vector<std::uint32_t> entries_;
};

// Writes the camera, as it stands in a world with `origin` at zero.
void set_camera(const View& view, const glm::dvec3& origin, gpu::Frame& frame);

// kFeature bits that the camera needs.
gpu::Feature camera_features(const gpu::Frame& frame);

// Numbers and kinds of Workspace::bindings(), without buffers.
std::vector<Binding> workspace_layout();

// One binding set for each band of the film: the workspace's bindings and `own`.
std::vector<std::unique_ptr<BindingSet>> bind_bands(const Workspace& workspace, const std::vector<Binding>& own);

// Number of paths in flight: as many as the render has, within 1/8 of the device's memory, one storage buffer and the
// limit of a dispatch. A CPU gains nothing once its caches are full; a GPU needs millions to hide latency. `features`:
// kFeature bits of the scene.
std::uint32_t choose_slots(const DeviceInfo& info, gpu::Feature features, const RenderPlan& settings);

} // namespace wavepath
