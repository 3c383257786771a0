#include "host/gpu/buffer.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/gpu/staging.h"
#include "kernels/gpu.h"

namespace wavepath {
namespace {

constexpr std::uint64_t kSmallest = 256; // bytes: the largest element that any empty binding could be asked for
constexpr VkMemoryPropertyFlags kHostFlags = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
constexpr VkMemoryPropertyFlags kHostCachedFlags =
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;

// The size to create. llvmpipe compiles a kernel again for every combination of texel buffers whose size is a power of
// two or has bits 8 to 15 clear (it reads the size as properties of a texture). Kernels are compiled before the buffers
// have their final size, so such sizes are avoided.
std::uint64_t created_bytes(std::uint64_t bytes) {
  bytes = std::max(bytes, kSmallest);
  return std::has_single_bit(bytes) || (bytes & 0xff00) == 0 ? bytes + kBufferPadding : bytes;
}

// Memory properties to try, best first. The host reads uncached memory slowly, so cached memory that needs an
// invalidate comes before uncached memory.
std::vector<VkMemoryPropertyFlags> wishes(const Device& device, BufferHome home) {
  if (home == BufferHome::readback) return {kHostFlags | kHostCachedFlags, kHostCachedFlags, kHostFlags};
  if (device.unified_memory()) return {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | kHostFlags, kHostFlags};
  return {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0};
}

} // namespace

Buffer::Buffer(Device& device, std::uint64_t bytes, BufferHome home) : device_(&device), bytes_(bytes), home_(home) {
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = created_bytes(bytes);
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
               VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
               VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  check(vkCreateBuffer(device.handle(), &info, nullptr, &buffer_), "creating a buffer");

  VkMemoryRequirements needs{};
  vkGetBufferMemoryRequirements(device.handle(), buffer_, &needs);
  allocated_ = needs.size;
  for (const VkMemoryPropertyFlags flags : wishes(device, home)) {
    if (!allocate(needs.memoryTypeBits, flags)) continue;
    device.count_memory(static_cast<std::int64_t>(allocated_));
    return;
  }
  vkDestroyBuffer(device.handle(), buffer_, nullptr);
  throw Error(device.info().name, fmt::format("no memory for a buffer of {:.1f} MiB", bytes / 1048576.0),
              "use a smaller --size or scene, or close other programs");
}

// Allocates, binds and maps allocated_ bytes of memory that has `flags`. False if there is no such memory.
bool Buffer::allocate(std::uint32_t type_bits, VkMemoryPropertyFlags flags) {
  const std::uint32_t type = device_->memory_type(type_bits, flags);
  if (type == gpu::kNone) return false;
  VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  info.allocationSize = allocated_;
  info.memoryTypeIndex = type;
  if (vkAllocateMemory(device_->handle(), &info, nullptr, &memory_) != VK_SUCCESS) return false;
  VkResult result = vkBindBufferMemory(device_->handle(), buffer_, memory_, 0);
  if (result == VK_SUCCESS && (flags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT)) {
    coherent_ = (flags & VK_MEMORY_PROPERTY_HOST_COHERENT_BIT) != 0;
    result = vkMapMemory(device_->handle(), memory_, 0, VK_WHOLE_SIZE, 0, &mapped_);
  }
  if (result == VK_SUCCESS) return true;
  vkFreeMemory(device_->handle(), memory_, nullptr);
  memory_ = VK_NULL_HANDLE;
  return false;
}

Buffer::~Buffer() {
  if (!buffer_) return;
  vkDestroyBuffer(device_->handle(), buffer_, nullptr);
  vkFreeMemory(device_->handle(), memory_, nullptr);
  device_->count_memory(-static_cast<std::int64_t>(allocated_));
}

void Buffer::swap(Buffer& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(buffer_, other.buffer_);
  std::swap(memory_, other.memory_);
  std::swap(bytes_, other.bytes_);
  std::swap(allocated_, other.allocated_);
  std::swap(home_, other.home_);
  std::swap(coherent_, other.coherent_);
  std::swap(mapped_, other.mapped_);
}

void Buffer::invalidate() const {
  if (!mapped_ || coherent_) return;
  const VkMappedMemoryRange range{VK_STRUCTURE_TYPE_MAPPED_MEMORY_RANGE, nullptr, memory_, 0, VK_WHOLE_SIZE};
  check(vkInvalidateMappedMemoryRanges(device_->handle(), 1, &range), "reading mapped memory");
}

void Buffer::flush() const {
  if (!mapped_ || coherent_) return;
  const VkMappedMemoryRange range{VK_STRUCTURE_TYPE_MAPPED_MEMORY_RANGE, nullptr, memory_, 0, VK_WHOLE_SIZE};
  check(vkFlushMappedMemoryRanges(device_->handle(), 1, &range), "writing mapped memory");
}

void Buffer::write(const void* data, std::uint64_t bytes, std::uint64_t offset) {
  assert(offset + bytes <= bytes_);
  if (!mapped_) return device_->staging().write(buffer_, offset, data, bytes);
  std::memcpy(static_cast<char*>(mapped_) + offset, data, bytes);
  flush();
}

void Buffer::read(void* data, std::uint64_t bytes, std::uint64_t offset) const {
  assert(offset + bytes <= bytes_);
  if (!mapped_) return device_->staging().read(buffer_, offset, data, bytes);
  invalidate();
  std::memcpy(data, static_cast<const char*>(mapped_) + offset, bytes);
}

void Buffer::fill_zero(std::uint64_t bytes) {
  assert(bytes <= bytes_ && bytes % 4 == 0);
  if (bytes == 0) return;
  if (!mapped_) return device_->staging().fill_zero(buffer_, bytes);
  std::memset(mapped_, 0, bytes);
  flush();
}

} // namespace wavepath
