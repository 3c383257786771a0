#include "host/gpu/staging.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "host/base/error.h"
#include "host/gpu/barrier.h"

namespace wavepath {
namespace {

// Larger copies go in pieces, so that staging never doubles the memory of a large scene.
constexpr std::uint64_t kMostBytes = 64ull << 20, kLeastBytes = 64ull << 10;

} // namespace

Staging::Staging(Context& context) : context_(context) {
  if (context.use() == DeviceUse::compile) return; // which copies nothing
  try {
    VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
    pool.queueFamilyIndex = context.queue_family();
    check(vkCreateCommandPool(context.handle(), &pool, nullptr, &pool_), "creating a command pool");
    VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocate.commandPool = pool_;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    check(vkAllocateCommandBuffers(context.handle(), &allocate, &commands_), "allocating a command buffer");
    const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, nullptr, 0};
    check(vkCreateFence(context.handle(), &fence, nullptr, &fence_), "creating a fence");
  } catch (...) {
    release();
    throw;
  }
}

Staging::~Staging() { release(); }

void Staging::release() {
  release_buffer();
  vkDestroyFence(context_.handle(), fence_, nullptr);
  vkDestroyCommandPool(context_.handle(), pool_, nullptr);
}

void Staging::release_buffer() {
  vkDestroyBuffer(context_.handle(), buffer_, nullptr);
  buffer_ = VK_NULL_HANDLE;
  memory_.release();
  bytes_ = 0;
}

void Staging::grow(std::uint64_t bytes) {
  bytes = std::bit_ceil(std::clamp(bytes, kLeastBytes, kMostBytes));
  if (bytes_ >= bytes) return;
  release_buffer(); // before the larger one is allocated
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = bytes;
  info.usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  check(vkCreateBuffer(context_.handle(), &info, nullptr, &buffer_), "creating a buffer");
  VkMemoryRequirements needs{};
  vkGetBufferMemoryRequirements(context_.handle(), buffer_, &needs);
  if (!memory_.allocate(context_, needs, kForReadback))
    throw Error(context_.info().name, "no memory for copies between host and device", "close other programs");
  check(vkBindBufferMemory(context_.handle(), buffer_, memory_.handle(), 0), "binding memory");
  bytes_ = bytes;
}

void Staging::write(VkBuffer to, std::uint64_t offset, const void* data, std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  grow(bytes);
  for (std::uint64_t done = 0; done < bytes;) {
    const std::uint64_t piece = std::min(bytes - done, bytes_);
    std::memcpy(memory_.mapped(), static_cast<const char*>(data) + done, piece);
    memory_.flush();
    const VkBufferCopy region{0, offset + done, piece};
    submit([&] { vkCmdCopyBuffer(commands_, buffer_, to, 1, &region); });
    done += piece;
  }
}

void Staging::read(VkBuffer from, std::uint64_t offset, void* data, std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  grow(bytes);
  for (std::uint64_t done = 0; done < bytes;) {
    const std::uint64_t piece = std::min(bytes - done, bytes_);
    const VkBufferCopy region{offset + done, 0, piece};
    submit([&] { vkCmdCopyBuffer(commands_, from, buffer_, 1, &region); });
    memory_.invalidate();
    std::memcpy(static_cast<char*>(data) + done, memory_.mapped(), piece);
    done += piece;
  }
}

void Staging::fill_zero(VkBuffer buffer, std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  submit([&] { vkCmdFillBuffer(commands_, buffer, 0, bytes, 0); });
}

// Work that was submitted earlier may still run, so the copy is ordered after all of it, and all later work after the
// copy.
void Staging::submit(const std::function<void()>& record) {
  check(vkResetCommandPool(context_.handle(), pool_, 0), "recording a copy");
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(vkBeginCommandBuffer(commands_, &begin), "recording a copy");
  record_barrier(commands_, kWritten, kUsedByCopy);
  record();
  record_barrier(commands_, kWrittenByCopy, kUsed);
  record_barrier(commands_, kWrittenByCopy, kReadByHost);
  check(vkEndCommandBuffer(commands_), "recording a copy");

  VkCommandBufferSubmitInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  buffer.commandBuffer = commands_;
  VkSubmitInfo2 info{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  info.commandBufferInfoCount = 1;
  info.pCommandBufferInfos = &buffer;
  check(context_.submit(info, fence_), "submitting a copy");
  check(context_.wait(fence_), "waiting for the device");
  check(vkResetFences(context_.handle(), 1, &fence_), "waiting for the device");
}

} // namespace wavepath
