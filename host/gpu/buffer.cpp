#include "host/gpu/buffer.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "host/base/error.h"

namespace wavepath {
namespace {

constexpr std::uint64_t kSmallest = 256; // bytes: the largest element that any empty binding could be asked for

// The size to create. llvmpipe compiles a kernel again for every combination of texel buffers whose size is a power of
// two or has bits 8 to 15 clear (it reads the size as properties of a texture). Kernels are compiled before the buffers
// have their final size, so such sizes are avoided.
std::uint64_t created_bytes(std::uint64_t bytes) {
  bytes = std::max(bytes, kSmallest);
  return std::has_single_bit(bytes) || (bytes & 0xff00) == 0 ? bytes + kBufferPadding : bytes;
}

std::span<const VkMemoryPropertyFlags> wishes(const Device& device, BufferHome home) {
  if (home == BufferHome::readback) return kForReadback;
  if (device.unified_memory()) return kUnified;
  return kDeviceLocal;
}

} // namespace

Buffer::Buffer(Device& device, std::uint64_t bytes, BufferHome home) : device_(&device), bytes_(bytes), home_(home) {
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = created_bytes(bytes);
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
               VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
               VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  const bool addressed = home == BufferHome::addressed;
  if (addressed)
    info.usage |= VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT | VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR |
                  VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR;
  check(vkCreateBuffer(device.handle(), &info, nullptr, &buffer_), "creating a buffer");

  VkMemoryRequirements needs{};
  vkGetBufferMemoryRequirements(device.handle(), buffer_, &needs);
  if (memory_.allocate(device, needs, wishes(device, home), addressed) &&
      vkBindBufferMemory(device.handle(), buffer_, memory_.handle(), 0) == VK_SUCCESS)
    return;
  vkDestroyBuffer(device.handle(), buffer_, nullptr);
  throw Error(device.info().name, fmt::format("no memory for a buffer of {:.1f} MiB", bytes / 1048576.0),
              "use a smaller --size or scene, or close other programs");
}

// The buffer goes before the memory that it is bound to.
Buffer::~Buffer() {
  if (buffer_) vkDestroyBuffer(device_->handle(), buffer_, nullptr);
}

std::uint64_t Buffer::address() const {
  assert(home_ == BufferHome::addressed);
  const VkBufferDeviceAddressInfo info{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO, nullptr, buffer_};
  return vkGetBufferDeviceAddress(device_->handle(), &info);
}

void Buffer::swap(Buffer& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(buffer_, other.buffer_);
  std::swap(memory_, other.memory_);
  std::swap(bytes_, other.bytes_);
  std::swap(home_, other.home_);
}

void Buffer::write(const void* data, std::uint64_t bytes, std::uint64_t offset) {
  assert(offset + bytes <= bytes_);
  if (!memory_.mapped()) return device_->staging().write(buffer_, offset, data, bytes);
  std::memcpy(static_cast<char*>(memory_.mapped()) + offset, data, bytes);
  memory_.flush();
}

void Buffer::read(void* data, std::uint64_t bytes, std::uint64_t offset) const {
  assert(offset + bytes <= bytes_);
  if (!memory_.mapped()) return device_->staging().read(buffer_, offset, data, bytes);
  memory_.invalidate();
  std::memcpy(data, static_cast<const char*>(memory_.mapped()) + offset, bytes);
}

const void* Buffer::in_place() const {
  if (memory_.mapped()) memory_.invalidate();
  return memory_.mapped();
}

void Buffer::fill_zero(std::uint64_t bytes) {
  assert(bytes <= bytes_ && bytes % 4 == 0);
  if (bytes == 0) return;
  if (!memory_.mapped()) return device_->staging().fill_zero(buffer_, bytes);
  std::memset(memory_.mapped(), 0, bytes);
  memory_.flush();
}

} // namespace wavepath
