#include "host/gpu/commands.h"

#include <cassert>

#include "host/base/error.h"
#include "host/gpu/barrier.h"

namespace wavepath {

Commands::Commands(Device& device, std::uint32_t timed_dispatches) : device_(&device) {
  try {
    create();
    begin(timed_dispatches);
  } catch (...) {
    release();
    throw;
  }
}

Commands::~Commands() {
  if (in_flight_) device_->wait(fence_);
  release();
}

void Commands::create() {
  VkCommandPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool_info.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
  pool_info.queueFamilyIndex = device_->queue_family();
  check(vkCreateCommandPool(device_->handle(), &pool_info, nullptr, &pool_), "creating a command pool");
  VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  allocate.commandPool = pool_;
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  check(vkAllocateCommandBuffers(device_->handle(), &allocate, &commands_), "allocating a command buffer");
  const VkFenceCreateInfo fence_info{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, nullptr, 0};
  check(vkCreateFence(device_->handle(), &fence_info, nullptr, &fence_), "creating a fence");
}

void Commands::begin(std::uint32_t timed_dispatches) {
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(vkBeginCommandBuffer(commands_, &begin), "recording");
  bindings_ = nullptr;
  timed_.clear();
  query_limit_ = device_->info().timestamp_period_ns > 0.0 ? timed_dispatches * 2 : 0;
  if (query_limit_ > query_capacity_) {
    vkDestroyQueryPool(device_->handle(), queries_, nullptr);
    queries_ = VK_NULL_HANDLE;
    VkQueryPoolCreateInfo query_info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    query_info.queryType = VK_QUERY_TYPE_TIMESTAMP;
    query_info.queryCount = query_limit_;
    check(vkCreateQueryPool(device_->handle(), &query_info, nullptr, &queries_), "creating timestamps");
    query_capacity_ = query_limit_;
  }
  if (query_limit_ > 0) vkCmdResetQueryPool(commands_, queries_, 0, query_limit_);
  // Nothing waits on the host between submissions, so that the order is made here.
  record_barrier(commands_, kWritten, kUsed);
}

void Commands::restart(std::uint32_t timed_dispatches) {
  wait();
  check(vkResetCommandPool(device_->handle(), pool_, 0), "recording");
  begin(timed_dispatches);
}

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
    vkCmdPushConstants(commands_, bindings_->layout(), bindings_->stages(), 0, bindings_->push_constant_bytes(), push);
  timing_ = timed_.size() * 2 < query_limit_;
  if (!timing_) return;
  write_time(static_cast<std::uint32_t>(timed_.size() * 2));
  timed_.push_back(&kernel);
}

void Commands::stop() {
  if (timing_) write_time(static_cast<std::uint32_t>(timed_.size() * 2 - 1));
}

// Where dispatches are done at once, waiting for them would tell the same and takes longer than a short one.
void Commands::write_time(std::uint32_t query) {
  const bool at_once = device_->info().dispatches_at_once, flushes = at_once && device_->has_rasterized();
  const VkPipelineStageFlags2 after =
      at_once && !flushes ? VK_PIPELINE_STAGE_2_TOP_OF_PIPE_BIT : VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  vkCmdWriteTimestamp2(commands_, after, queries_, query);
  if (flushes) barrier();
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
  record_barrier(commands_, written_by_shader_or_copy(*device_), kWrittenByCopy);
  vkCmdUpdateBuffer(commands_, buffer.handle(), 0, bytes, data);
  record_barrier(commands_, kWrittenByCopy, used_by_shader_or_copy(*device_));
}

void Commands::copy(const Buffer& from, const Buffer& to, std::uint64_t bytes, Order order) {
  const VkBufferCopy region{0, 0, bytes};
  if (order == Order::unordered) return vkCmdCopyBuffer(commands_, from.handle(), to.handle(), 1, &region);
  record_barrier(commands_, written_by_shader_or_copy(*device_), kUsedByCopy);
  vkCmdCopyBuffer(commands_, from.handle(), to.handle(), 1, &region);
  record_barrier(commands_, kWrittenByCopy, used_by_shader_or_copy(*device_));
}

void Commands::barrier() { record_barrier(commands_, kWrittenByKernel, kUsedByKernel); }

void Commands::submit() {
  // Make results visible to host reads of mapped memory.
  record_barrier(commands_, kWrittenByKernelOrCopy, kReadByHost);
  check(vkEndCommandBuffer(commands_), "recording");
  VkCommandBufferSubmitInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  buffer.commandBuffer = commands_;
  VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  submit.commandBufferInfoCount = 1;
  submit.pCommandBufferInfos = &buffer;
  check(device_->submit(submit, fence_), "submitting work");
  in_flight_ = true;
}

void Commands::wait() {
  if (!in_flight_) return;
  check(device_->wait(fence_), "waiting for the device");
  check(vkResetFences(device_->handle(), 1, &fence_), "waiting for the device");
  in_flight_ = false;
}

std::vector<KernelTime> Commands::times() const {
  std::vector<KernelTime> result;
  if (timed_.empty()) return result;
  std::vector<std::uint64_t> ticks(timed_.size() * 2);
  check(vkGetQueryPoolResults(device_->handle(), queries_, 0, static_cast<std::uint32_t>(ticks.size()),
                              ticks.size() * 8, ticks.data(), 8, VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
        "reading timestamps");
  const DeviceInfo& info = device_->info();
  for (std::size_t i = 0; i < timed_.size(); ++i) {
    const std::uint64_t passed = ticks_between(ticks[2 * i], ticks[2 * i + 1], info.timestamp_bits);
    result.push_back({timed_[i], static_cast<double>(passed) * 1e-9 * info.timestamp_period_ns});
  }
  return result;
}

} // namespace wavepath
