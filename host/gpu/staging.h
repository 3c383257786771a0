// Copies between the host and device memory that the host cannot map. One buffer, command buffer and fence serve all
// copies of a device, because read-backs are frequent and allocating memory for each costs more than a small copy.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>

#include <vulkan/vulkan.h>

#include "host/gpu/memory.h"

namespace wavepath {

// Copies. Every call waits for all earlier work of the queue and for its own copy. Safe to call from several threads.
class Staging {
public:
  explicit Staging(Context& context);
  ~Staging();
  Staging(Staging&&) = delete;

  void write(VkBuffer to, std::uint64_t offset, const void* data, std::uint64_t bytes);
  void read(VkBuffer from, std::uint64_t offset, void* data, std::uint64_t bytes);
  void fill_zero(VkBuffer buffer, std::uint64_t bytes); // clears the first `bytes` bytes, a multiple of 4

private:
  void grow(std::uint64_t bytes);
  void submit(const std::function<void()>& record);
  void release();
  void release_buffer();

  Context& context_;
  std::mutex mutex_; // guards everything below
  VkBuffer buffer_ = VK_NULL_HANDLE;
  Memory memory_;           // mapped memory of the buffer
  std::uint64_t bytes_ = 0; // size: the largest copy so far, up to a limit
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
};

} // namespace wavepath
