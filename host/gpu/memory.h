// Memory of the device that one buffer or image is bound to, mapped where the host can reach it.
#pragma once

#include <cstdint>
#include <span>

#include <vulkan/vulkan.h>

#include "host/gpu/context.h"

namespace wavepath {

class Memory {
public:
  Memory() = default;
  ~Memory() { release(); }
  Memory(Memory&& other) noexcept { swap(other); }
  Memory& operator=(Memory&& other) noexcept {
    swap(other);
    return *this;
  }

  // Allocates, and maps what can be mapped. `wishes`: properties to try, best first. `addressed`: buffers there have
  // device addresses. False if there is no such memory.
  bool allocate(Context& context, const VkMemoryRequirements& needs, std::span<const VkMemoryPropertyFlags> wishes,
                bool addressed = false);
  void release();

  VkDeviceMemory handle() const { return memory_; }
  std::uint64_t bytes() const { return bytes_; }
  void* mapped() const { return mapped_; } // null: the host cannot reach it
  // Before the host reads what the device wrote, and after the host has written. Nothing where caches are coherent.
  void invalidate() const;
  void flush() const;

private:
  void swap(Memory& other) noexcept;
  bool try_to_allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags flags, bool displaced, bool addressed);

  Context* context_ = nullptr;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  std::uint64_t bytes_ = 0;
  bool coherent_ = true;
  void* mapped_ = nullptr;
};

// Properties to wish for. The host reads uncached memory slowly, so for `kForReadback` cached memory that needs an
// invalidate comes before uncached memory.
inline constexpr VkMemoryPropertyFlags kHostCoherent =
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
inline constexpr VkMemoryPropertyFlags kHostCached =
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
inline constexpr VkMemoryPropertyFlags kForReadback[] = {kHostCoherent | kHostCached, kHostCached, kHostCoherent};
inline constexpr VkMemoryPropertyFlags kUnified[] = {
    VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | kHostCoherent | kHostCached, // integrated GPUs list uncached memory first
    VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | kHostCoherent, kHostCoherent};
inline constexpr VkMemoryPropertyFlags kDeviceLocal[] = {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0};

} // namespace wavepath
