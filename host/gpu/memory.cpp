#include "host/gpu/memory.h"

#include <utility>

#include "kernels/base/gpu.h"

namespace wavepath {

bool Memory::allocate(Context& context, const VkMemoryRequirements& needs,
                      std::span<const VkMemoryPropertyFlags> wishes, bool addressed) {
  release();
  context_ = &context;
  for (const VkMemoryPropertyFlags flags : wishes) {
    const bool displaced = wishes.front() == VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT && flags != wishes.front();
    if (try_to_allocate(needs, flags, displaced, addressed)) return true;
  }
  return false;
}

bool Memory::try_to_allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags flags, bool displaced,
                             bool addressed) {
  VkMemoryAllocateFlagsInfo address{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO};
  address.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
  VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  info.pNext = addressed ? &address : nullptr;
  info.allocationSize = needs.size;
  info.memoryTypeIndex = context_->memory_type(needs.memoryTypeBits, flags);
  if (info.memoryTypeIndex == gpu::kNone) return false;
  if (vkAllocateMemory(context_->handle(), &info, nullptr, &memory_) != VK_SUCCESS) {
    memory_ = VK_NULL_HANDLE;
    return false;
  }
  bytes_ = needs.size;
  context_->count_memory(static_cast<std::int64_t>(bytes_), displaced);
  if (!(flags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT)) return true;
  coherent_ = (flags & VK_MEMORY_PROPERTY_HOST_COHERENT_BIT) != 0;
  if (vkMapMemory(context_->handle(), memory_, 0, VK_WHOLE_SIZE, 0, &mapped_) == VK_SUCCESS) return true;
  release();
  return false;
}

void Memory::release() {
  if (!memory_) return;
  vkFreeMemory(context_->handle(), memory_, nullptr);
  context_->count_memory(-static_cast<std::int64_t>(bytes_));
  memory_ = VK_NULL_HANDLE;
  bytes_ = 0;
  mapped_ = nullptr;
  coherent_ = true;
}

void Memory::swap(Memory& other) noexcept {
  std::swap(context_, other.context_);
  std::swap(memory_, other.memory_);
  std::swap(bytes_, other.bytes_);
  std::swap(coherent_, other.coherent_);
  std::swap(mapped_, other.mapped_);
}

void Memory::invalidate() const {
  if (!mapped_ || coherent_) return;
  const VkMappedMemoryRange range{VK_STRUCTURE_TYPE_MAPPED_MEMORY_RANGE, nullptr, memory_, 0, VK_WHOLE_SIZE};
  check(vkInvalidateMappedMemoryRanges(context_->handle(), 1, &range), "reading mapped memory");
}

void Memory::flush() const {
  if (!mapped_ || coherent_) return;
  const VkMappedMemoryRange range{VK_STRUCTURE_TYPE_MAPPED_MEMORY_RANGE, nullptr, memory_, 0, VK_WHOLE_SIZE};
  check(vkFlushMappedMemoryRanges(context_->handle(), 1, &range), "writing mapped memory");
}

} // namespace wavepath
