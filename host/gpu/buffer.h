// Buffers in device memory or in mapped host memory, with copies to and from the host.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vulkan/vulkan.h>

#include "host/gpu/device.h"
#include "host/gpu/memory.h"

namespace wavepath {

// Memory that a buffer lives in: `device` is fastest for kernels; `readback` is mapped host memory that the device
// copies results to; `addressed` is like `device`, for structures of ray queries and their inputs, which are named by
// address (needs DeviceInfo::has_ray_queries).
enum class BufferHome { device, readback, addressed };

// Storage, uniform, texel, indirect and copy use are all allowed. A request for zero bytes yields a small buffer,
// because every declared binding must be written (Mesa 22.3 crashes otherwise).
class Buffer {
public:
  Buffer() = default;
  Buffer(Device& device, std::uint64_t bytes, BufferHome home = BufferHome::device);
  ~Buffer();
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    swap(other);
    return *this;
  }

  VkBuffer handle() const { return buffer_; }
  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t address() const; // address of an `addressed` buffer

  // The memory of a `readback` buffer; null for `device`. To read what commands wrote, the host waits for their fence
  // (Commands makes their writes visible to the host) and calls invalidate().
  void* mapped() { return home_ == BufferHome::readback ? memory_.mapped() : nullptr; }
  const void* mapped() const { return home_ == BufferHome::readback ? memory_.mapped() : nullptr; }
  void invalidate() const { memory_.invalidate(); }

  // Copies between host and device, which return when they are done. Ranges must lie inside the buffer. A buffer that
  // the host can map is accessed at once; any other copy comes after all that was submitted to the queue.
  void write(const void* data, std::uint64_t bytes, std::uint64_t offset = 0);
  void read(void* data, std::uint64_t bytes, std::uint64_t offset = 0) const;
  // The memory itself, as finished commands left it, where the host can map it; else null, and read() copies it.
  const void* in_place() const;
  void fill_zero() { fill_zero(bytes_); }
  void fill_zero(std::uint64_t bytes); // clears the first `bytes` bytes, a multiple of 4

private:
  void swap(Buffer& other) noexcept;

  Device* device_ = nullptr;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  Memory memory_; // if not mapped, it is reached by staging
  std::uint64_t bytes_ = 0;
  BufferHome home_ = BufferHome::device;
};

// A device buffer holding a copy of `values`.
template <class T>
Buffer upload(Device& device, const std::vector<T>& values) {
  Buffer buffer(device, values.size() * sizeof(T));
  if (!values.empty()) buffer.write(values.data(), values.size() * sizeof(T));
  return buffer;
}

// The first `count` values, in place where the host can map them; else `copy` holds them.
template <class T>
std::span<const T> look_at(const Buffer& buffer, std::size_t count, std::vector<T>& copy) {
  if (const void* values = buffer.in_place()) return {static_cast<const T*>(values), count};
  copy.resize(count);
  if (count) buffer.read(copy.data(), count * sizeof(T));
  return copy;
}

template <class T>
std::vector<T> download(const Buffer& buffer, std::size_t count, std::uint64_t offset = 0) {
  std::vector<T> values(count);
  if (count) buffer.read(values.data(), count * sizeof(T), offset);
  return values;
}

} // namespace wavepath
