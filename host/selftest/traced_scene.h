// A packed scene on the device with the shipped ray kernels over it, alone: rays in, hits out.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <tuple>
#include <vector>

#include "host/gpu/kernel.h"
#include "host/render/workspace/device_scene.h"
#include "host/scene/pack/pack.h"
#include "kernels/base/frame_types.h"
#include "kernels/path/path_types.h"

namespace wavepath {

// The path tracer's bindings: those `given`, and `unused` for all others.
std::unique_ptr<BindingSet> bind_path_tracer(Device& device, std::span<const Binding> given, const Buffer& unused);

// Kernels bound as the path tracer binds them, each compiled once for all cases.
class KernelCache {
public:
  explicit KernelCache(Device& device) : device_(device) {}

  const Kernel& get(std::span<const std::uint32_t> spirv, gpu::Feature features, std::uint32_t stack_size,
                    const BindingSet& bindings);

private:
  Device& device_;
  std::map<std::tuple<const std::uint32_t*, gpu::Feature, std::uint32_t>, Kernel> kernels_;
};

class TracedScene {
public:
  // Rays at a time: a hundredth of a second on a slow CPU, and two queues fit the smallest texel buffer that Vulkan
  // allows; a few hundredths where each ray meets thousands of triangles.
  static constexpr std::uint32_t kSlots = 1u << 13, kSlowSlots = 1u << 11;

  // `by_query`: rays are traced by the device's ray queries, which it then has.
  TracedScene(Device& device, KernelCache& kernels, PackedScene packed, bool by_query = false);
  TracedScene(TracedScene&&) = delete; // the bindings point at its buffers

  const PackedScene& packed() const { return packed_; }

  // From now on its rays are the camera's, which single-sided surfaces let pass from behind. Else they are those of a
  // bounce, which lanes of GPUs take from the queue one after the other.
  void use_camera_rays() { bounce_ = 0; }

  // In device space (the world moved by -packed().origin), slots ignored. `closest` returns what extend.comp finds,
  // `blocked` whether connect.comp finds anything, by ray.
  std::vector<gpu::Hit> closest(std::span<const gpu::Ray> rays, std::uint32_t at_once = kSlots);
  std::vector<bool> blocked(std::span<const gpu::Ray> rays);

  // Runs a kernel with these rays in the first queue, `at_once` lanes a dispatch; returns what it left as hits. The
  // kernel finds `parameter` in wave.sample_count.
  std::vector<gpu::Hit> run(std::span<const std::uint32_t> spirv, std::span<const gpu::Ray> rays,
                            std::uint32_t parameter, std::uint32_t at_once = kSlots);
  // The rays as the last dispatch left them.
  std::vector<gpu::Ray> rays_left(std::size_t count) const;

private:
  void dispatch(std::span<const std::uint32_t> spirv, std::size_t count, std::uint32_t parameter);

  Device& device_;
  KernelCache& kernels_;
  PackedScene packed_;
  DeviceScene scene_;
  std::uint32_t bounce_ = 2; // whose rays lie in the first queue, too
  Buffer frame_, states_, rays_, hits_, shadow_rays_, queues_, unused_;
  std::unique_ptr<BindingSet> bindings_;
};

} // namespace wavepath
