// A command buffer that is recorded, submitted and waited for, with a time for every kernel it ran.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

#include "host/gpu/kernel.h"

namespace wavepath {

struct KernelTime {
  const Kernel* kernel = nullptr;
  double seconds = 0.0;
};

class Commands {
public:
  // Begins recording. `max_timed_dispatches`: dispatches beyond it, or on a queue without timestamps, are not timed.
  explicit Commands(Device& device, std::uint32_t max_timed_dispatches = 0);
  ~Commands();
  Commands(Commands&&) = delete;

  VkCommandBuffer handle() const { return commands_; }

  void bind(const BindingSet& bindings);
  // `push`: bindings.push_constant_bytes() bytes; `groups` workgroups along x.
  void dispatch(const Kernel& kernel, std::uint32_t groups, const void* push = nullptr);
  // Group counts are read from `arguments` at `offset`.
  void dispatch_indirect(const Kernel& kernel, const Buffer& arguments, std::uint64_t offset,
                         const void* push = nullptr);
  // Copies `bytes` (a multiple of 4, at most 65536) into `buffer` when the device gets there: after all that was recorded
  // before, visible to all that follows.
  void write(const Buffer& buffer, const void* data, std::uint64_t bytes);
  // The first `bytes` bytes of a buffer into another.
  void copy(const Buffer& from, const Buffer& to, std::uint64_t bytes);
  // Everything written so far is visible to every dispatch, indirect read and copy that follows.
  void barrier();

  // Ends recording, runs it, waits. Throws Error if the device fails. Afterwards times() is known.
  void submit_and_wait();
  std::vector<KernelTime> times() const;

private:
  void start(const Kernel& kernel, const void* push);
  void stop();
  void write_time(std::uint32_t query);
  void release();

  Device* device_;
  const BindingSet* bindings_ = nullptr;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  VkQueryPool queries_ = VK_NULL_HANDLE;
  std::uint32_t query_capacity_ = 0;
  std::vector<const Kernel*> timed_;
  bool timing_ = false; // the dispatch being recorded is timed
};

} // namespace wavepath
