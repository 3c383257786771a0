// A Vulkan 1.3 device with one queue for compute, and graphics where there is such a one: chosen, checked, and released at the end of its scope.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

namespace wavepath {

class PipelineCache; // host/gpu/pipeline_cache.h

// Bytes that a Buffer may be larger than asked for (see buffer.cpp). DeviceInfo's limits on bindings are what is left.
inline constexpr std::uint64_t kBufferPadding = 0x110;

// What `wavepath info` tells of a device. `missing`: what keeps us from using it, in words; empty = usable.
struct DeviceInfo {
  std::string name, driver, type; // type: cpu, integrated, discrete, virtual, other
  std::string api;                // "1.3.230"
  std::uint32_t subgroup_size = 0;
  std::uint64_t memory_bytes = 0; // largest device-local heap
  std::uint64_t max_storage_range = 0, max_texel_elements = 0, max_allocation = 0;
  std::uint32_t max_groups = 0;
  double timestamp_period_ns = 0.0; // 0 = the queue has no timestamps
  bool rasterizes = false;         // its queue takes graphics work as well
  std::vector<std::string> missing;
};

// Throws Error naming `what` and the driver's answer unless `result` is VK_SUCCESS.
void check(VkResult result, const char* what);

// Every device of the machine, in the order that --device INDEX counts.
std::vector<DeviceInfo> list_devices();

class Device {
public:
  // `wanted`: an index, or part of a name (case-insensitive); empty = a discrete GPU if there is one, then integrated, virtual,
  // CPU. Throws Error if none fits, naming those that exist. The environment variable WAVEPATH_VALIDATION=1 turns the
  // validation layer on, synchronization checks included.
  // `window_extensions`: of the instance, that a window needs; with any, the device can also fill swapchains.
  explicit Device(const std::string& wanted = "", std::span<const char* const> window_extensions = {});
  ~Device();
  Device(Device&&) = delete;

  const DeviceInfo& info() const { return info_; }
  VkInstance instance() const { return instance_; }
  VkPhysicalDevice physical() const { return physical_; }
  VkDevice handle() const { return device_; }
  VkQueue queue() const { return queue_; }
  std::uint32_t queue_family() const { return queue_family_; }
  PipelineCache& pipeline_cache() const { return *pipeline_cache_; }
  // Whether the queue can rasterize. Path tracing needs no such queue.
  bool rasterizes() const { return info_.rasterizes; }
  // True where host and device share memory, so that uploads need no staging.
  bool unified_memory() const { return unified_memory_; }

  // Index of a memory type among `type_bits` that has `flags`, kNone (all ones) if there is none.
  std::uint32_t memory_type(std::uint32_t type_bits, VkMemoryPropertyFlags flags) const;

  // To be held while work is submitted: Vulkan allows one thread at a time.
  std::mutex& queue_mutex() { return queue_mutex_; }

  // Bytes of device memory held by Buffers, now and at most.
  void count_memory(std::int64_t bytes);
  std::uint64_t memory_peak() const { return memory_peak_; }

  // Validation errors and warnings of this process so far; each was printed to stderr.
  static std::uint32_t validation_messages();

private:
  void release();

  DeviceInfo info_;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::uint32_t queue_family_ = 0;
  bool unified_memory_ = false;
  std::unique_ptr<PipelineCache> pipeline_cache_;
  VkPhysicalDeviceMemoryProperties memory_{};
  std::mutex queue_mutex_, memory_mutex_;
  std::uint64_t memory_now_ = 0, memory_peak_ = 0;
};

} // namespace wavepath
