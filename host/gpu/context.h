// A Vulkan 1.3 device, chosen and checked, with one queue for compute, which also rasterizes where such a queue exists.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

#include "host/base/worker_threads.h"
#include "host/gpu/device_info.h"

namespace wavepath {

class PipelineCache; // host/gpu/pipeline_cache.h

// Purpose that a device is opened for. `compile`: kernels are compiled for the statistics of the driver, and nothing is
// allocated or run, so that a driver without its hardware serves as well.
enum class DeviceUse { run, compile };

// A Buffer may be this many bytes larger than asked for (see buffer.cpp). DeviceInfo's limits are reduced by them.
inline constexpr std::uint64_t kBufferPadding = 0x110;

// Throws Error naming `what` and the driver's answer unless `result` is VK_SUCCESS.
void check(VkResult result, const char* what);

// Every device of the machine, in the order that --device INDEX counts.
std::vector<DeviceInfo> list_devices();

// Base of Device, which adds copies to memory that the host cannot map.
class Context {
public:
  // `wanted`: as choose_device() takes it (host/gpu/device_choice.h), whose Errors it throws.
  // `window_extensions`: instance extensions that a window needs; with any, the device can also fill swapchains.
  // Environment: WAVEPATH_VALIDATION=1 turns the validation layer on, synchronization validation included.
  // With it, reads outside of a buffer do not reach foreign memory, where the device can do that.
  // WAVEPATH_LOSE_DEVICE=N, for tests, has the device be lost after N submissions; N@K, the one that this process
  // opened after K others. WAVEPATH_EMULATE=discrete, for tests, has a CPU device report type "discrete" and treat its
  // memory as not mappable; WAVEPATH_EMULATE=few-texels has any device report the smallest texel buffers that Vulkan
  // allows. DeviceUse::compile wants VK_KHR_pipeline_executable_properties, and throws Error where the driver lacks it.
  explicit Context(const std::string& wanted = "", std::span<const char* const> window_extensions = {},
                   DeviceUse use = DeviceUse::run);
  ~Context();
  Context(Context&&) = delete;

  const DeviceInfo& info() const { return info_; }
  DeviceUse use() const { return use_; }
  VkInstance instance() const { return instance_; }
  VkPhysicalDevice physical() const { return physical_; }
  VkDevice handle() const { return device_; }
  VkQueue queue() const { return queue_; }
  std::uint32_t queue_family() const { return queue_family_; }
  PipelineCache& pipeline_cache() const { return *pipeline_cache_; }
  // True if the queue can rasterize. Path tracing needs no such queue.
  bool rasterizes() const { return info_.rasterizes; }
  // True if the host maps device memory, so that copies need no staging.
  bool unified_memory() const { return unified_memory_; }

  // True if anything may have been rasterized: a target of it was made, or the device can fill windows.
  bool has_rasterized() const { return has_rasterized_; }
  void note_rasterizing() { has_rasterized_ = true; }

  // Index of a memory type among `type_bits` that has `flags`, kNone (all ones) if there is none.
  std::uint32_t memory_type(std::uint32_t type_bits, VkMemoryPropertyFlags flags) const;

  // A thread holds it while it hands work to the queue by other means than submit(): Vulkan allows one at a time.
  std::mutex& queue_mutex() { return queue_mutex_; }
  VkResult submit(const VkSubmitInfo2& work, VkFence fence);
  // VK_TIMEOUT after kLongestWait: no dispatch takes nearly as long, so that the device has stopped.
  VkResult wait(VkFence fence) const;

  // Adds to the bytes of memory that buffers and images hold now; the peak follows. `displaced`: of memory that was to
  // be the device's own, and is not because that is full.
  void count_memory(std::int64_t bytes, bool displaced = false);
  std::uint64_t memory_peak() const { return memory_peak_; }
  std::uint64_t memory_displaced() const { return memory_displaced_; } // so far

  // For threads that the driver computes on, if any (host/base/worker_threads.h): to be called before work is
  // submitted.
  void prepare_workers() { workers_.prepare(); }

  // Validation errors and warnings of this process so far; each was printed to stderr.
  static std::uint32_t validation_messages();

private:
  static constexpr std::uint64_t kLongestWait = 600'000'000'000, kWaitSlice = 10'000'000'000; // nanoseconds

  void release();
  static std::uint64_t submissions_of_test();

  DeviceInfo info_;
  DeviceUse use_;
  WorkerThreads workers_;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::uint32_t queue_family_ = 0;
  bool unified_memory_ = false;
  std::atomic<bool> has_rasterized_;
  std::unique_ptr<PipelineCache> pipeline_cache_;
  VkPhysicalDeviceMemoryProperties memory_{};
  std::mutex queue_mutex_, memory_mutex_;
  std::uint64_t memory_now_ = 0, memory_peak_ = 0, memory_displaced_ = 0;
  std::uint64_t submissions_left_ = submissions_of_test();
  mutable std::atomic<bool> gone_ = false; // a wait has found the device lost, or silent; nobody waits for it again
};

} // namespace wavepath
