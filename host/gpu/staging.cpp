#include "host/gpu/staging.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "host/gpu/device.h"

namespace wavepath {
namespace {

// Larger copies go in pieces, so that staging never doubles the memory of a large scene.
constexpr std::uint64_t kMostBytes = 64ull << 20, kLeastBytes = 64ull << 10;

void record_barrier(VkCommandBuffer commands, VkPipelineStageFlags2 from, VkPipelineStageFlags2 to,
                    VkAccessFlags2 to_access) {
  VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  memory.srcStageMask = from;
  memory.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  memory.dstStageMask = to;
  memory.dstAccessMask = to_access;
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &memory;
  vkCmdPipelineBarrier2(commands, &info);
}

} // namespace

Staging::Staging(Device& device) : device_(device) {
  try {
    VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
    pool.queueFamilyIndex = device.queue_family();
    check(vkCreateCommandPool(device.handle(), &pool, nullptr, &pool_), "creating a command pool");
    VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocate.commandPool = pool_;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    check(vkAllocateCommandBuffers(device.handle(), &allocate, &commands_), "allocating a command buffer");
    const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, nullptr, 0};
    check(vkCreateFence(device.handle(), &fence, nullptr, &fence_), "creating a fence");
  } catch (...) {
    release();
    throw;
  }
}

Staging::~Staging() { release(); }

void Staging::release() {
  vkDestroyFence(device_.handle(), fence_, nullptr);
  vkDestroyCommandPool(device_.handle(), pool_, nullptr);
}

void Staging::grow(std::uint64_t bytes) {
  bytes = std::clamp(bytes, kLeastBytes, kMostBytes);
  if (buffer_.bytes() >= bytes) return;
  buffer_ = Buffer(); // before the larger one is allocated
  buffer_ = Buffer(device_, std::bit_ceil(bytes), BufferHome::readback);
}

void Staging::write(VkBuffer to, std::uint64_t offset, const void* data, std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  grow(bytes);
  for (std::uint64_t done = 0; done < bytes;) {
    const std::uint64_t piece = std::min(bytes - done, buffer_.bytes());
    buffer_.write(static_cast<const char*>(data) + done, piece);
    const VkBufferCopy region{0, offset + done, piece};
    submit([&] { vkCmdCopyBuffer(commands_, buffer_.handle(), to, 1, &region); });
    done += piece;
  }
}

void Staging::read(VkBuffer from, std::uint64_t offset, void* data, std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  grow(bytes);
  for (std::uint64_t done = 0; done < bytes;) {
    const std::uint64_t piece = std::min(bytes - done, buffer_.bytes());
    const VkBufferCopy region{offset + done, 0, piece};
    submit([&] { vkCmdCopyBuffer(commands_, from, buffer_.handle(), 1, &region); });
    buffer_.read(static_cast<char*>(data) + done, piece);
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
  check(vkResetCommandPool(device_.handle(), pool_, 0), "recording a copy");
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(vkBeginCommandBuffer(commands_, &begin), "recording a copy");
  record_barrier(commands_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_2_TRANSFER_BIT,
                 VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT);
  record();
  record_barrier(commands_, VK_PIPELINE_STAGE_2_TRANSFER_BIT,
                 VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_2_HOST_BIT,
                 VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT);
  check(vkEndCommandBuffer(commands_), "recording a copy");

  VkCommandBufferSubmitInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  buffer.commandBuffer = commands_;
  VkSubmitInfo2 info{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  info.commandBufferInfoCount = 1;
  info.pCommandBufferInfos = &buffer;
  {
    const std::lock_guard lock(device_.queue_mutex());
    check(vkQueueSubmit2(device_.queue(), 1, &info, fence_), "submitting a copy");
  }
  check(vkWaitForFences(device_.handle(), 1, &fence_, VK_TRUE, UINT64_MAX), "waiting for the device");
  check(vkResetFences(device_.handle(), 1, &fence_), "waiting for the device");
}

} // namespace wavepath
