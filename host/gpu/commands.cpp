#include "host/gpu/commands.h"

#include <cassert>

#include "host/base/error.h"

namespace wavepath {

Commands::Commands(Device& device, std::uint32_t max_timed_dispatches) : device_(&device) {
  try {
    VkCommandPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool_info.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
    pool_info.queueFamilyIndex = device.queue_family();
    check(vkCreateCommandPool(device.handle(), &pool_info, nullptr, &pool_), "creating a command pool");
    VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocate.commandPool = pool_;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    check(vkAllocateCommandBuffers(device.handle(), &allocate, &commands_), "allocating a command buffer");
    const VkFenceCreateInfo fence_info{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, nullptr, 0};
    check(vkCreateFence(device.handle(), &fence_info, nullptr, &fence_), "creating a fence");
    VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    check(vkBeginCommandBuffer(commands_, &begin), "recording");
    if (max_timed_dispatches > 0 && device.info().timestamp_period_ns > 0.0) {
      query_capacity_ = max_timed_dispatches * 2;
      VkQueryPoolCreateInfo query_info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
      query_info.queryType = VK_QUERY_TYPE_TIMESTAMP;
      query_info.queryCount = query_capacity_;
      check(vkCreateQueryPool(device.handle(), &query_info, nullptr, &queries_), "creating timestamps");
      vkCmdResetQueryPool(commands_, queries_, 0, query_capacity_);
    }
  } catch (...) {
    release();
    throw;
  }
}

Commands::~Commands() { release(); }

void Commands::release() {
  vkDestroyQueryPool(device_->handle(), queries_, nullptr);
  vkDestroyFence(device_->handle(), fence_, nullptr);
  vkDestroyCommandPool(device_->handle(), pool_, nullptr);
}

void Commands::bind(const BindingSet& bindings) {
  bindings_ = &bindings;
  const VkDescriptorSet set = bindings.handle();
  vkCmdBindDescriptorSets(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, bindings.layout(), 0, 1, &set, 0, nullptr);
}

void Commands::start(const Kernel& kernel, const void* push) {
  assert(bindings_ && "bind() comes first");
  vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.handle());
  if (push)
    vkCmdPushConstants(commands_, bindings_->layout(), bindings_->stages(), 0, bindings_->push_constant_bytes(),
                       push);
  timing_ = timed_.size() * 2 < query_capacity_;
  if (!timing_) return;
  write_time(static_cast<std::uint32_t>(timed_.size() * 2));
  timed_.push_back(&kernel);
}

void Commands::stop() {
  if (timing_) write_time(static_cast<std::uint32_t>(timed_.size() * 2 - 1));
}

// Once anything has been rasterized, llvmpipe (Mesa 22.3) takes the time not here but when it next flushes, which is what a
// barrier has it do.
void Commands::write_time(std::uint32_t query) {
  vkCmdWriteTimestamp2(commands_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries_, query);
  if (device_->info().type == "cpu") barrier();
}

void Commands::dispatch(const Kernel& kernel, std::uint32_t groups, const void* push) {
  start(kernel, push);
  vkCmdDispatch(commands_, groups, 1, 1);
  stop();
}

void Commands::dispatch_indirect(const Kernel& kernel, const Buffer& arguments, std::uint64_t offset,
                                 const void* push) {
  start(kernel, push);
  vkCmdDispatchIndirect(commands_, arguments.handle(), offset);
  stop();
}

void Commands::write(const Buffer& buffer, const void* data, std::uint64_t bytes) {
  barrier();
  vkCmdUpdateBuffer(commands_, buffer.handle(), 0, bytes, data);
  barrier();
}

void Commands::copy(const Buffer& from, const Buffer& to, std::uint64_t bytes) {
  const VkBufferCopy region{0, 0, bytes};
  vkCmdCopyBuffer(commands_, from.handle(), to.handle(), 1, &region);
}

void Commands::barrier() {
  VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  memory.srcStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_TRANSFER_BIT;
  memory.srcAccessMask = VK_ACCESS_2_SHADER_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT;
  memory.dstStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT |
                        VK_PIPELINE_STAGE_2_TRANSFER_BIT;
  memory.dstAccessMask = VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT | VK_ACCESS_2_UNIFORM_READ_BIT |
                         VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_2_TRANSFER_READ_BIT |
                         VK_ACCESS_2_TRANSFER_WRITE_BIT;
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &memory;
  vkCmdPipelineBarrier2(commands_, &info);
}

void Commands::submit_and_wait() {
  // Make results visible to host reads of mapped memory.
  VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  memory.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  memory.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  memory.dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
  memory.dstAccessMask = VK_ACCESS_2_HOST_READ_BIT;
  VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  dependency.memoryBarrierCount = 1;
  dependency.pMemoryBarriers = &memory;
  vkCmdPipelineBarrier2(commands_, &dependency);
  check(vkEndCommandBuffer(commands_), "recording");

  VkCommandBufferSubmitInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  buffer.commandBuffer = commands_;
  VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  submit.commandBufferInfoCount = 1;
  submit.pCommandBufferInfos = &buffer;
  {
    const std::lock_guard lock(device_->queue_mutex());
    check(vkQueueSubmit2(device_->queue(), 1, &submit, fence_), "submitting work");
  }
  check(vkWaitForFences(device_->handle(), 1, &fence_, VK_TRUE, UINT64_MAX), "waiting for the device");
}

std::vector<KernelTime> Commands::times() const {
  std::vector<KernelTime> result;
  if (timed_.empty()) return result;
  std::vector<std::uint64_t> ticks(timed_.size() * 2);
  check(vkGetQueryPoolResults(device_->handle(), queries_, 0, static_cast<std::uint32_t>(ticks.size()),
                              ticks.size() * 8, ticks.data(), 8, VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
        "reading timestamps");
  for (std::size_t i = 0; i < timed_.size(); ++i)
    result.push_back({timed_[i], static_cast<double>(ticks[2 * i + 1] - ticks[2 * i]) * 1e-9 *
                                     device_->info().timestamp_period_ns});
  return result;
}

} // namespace wavepath
