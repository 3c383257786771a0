#include "host/view/presenter.h"

#include <algorithm>

#include "host/view/overlay.h"

namespace wavepath {
namespace {

// Nanoseconds; some displays take nothing from windows that nobody sees.
constexpr std::uint64_t kPatience = 100'000'000;

VkImageMemoryBarrier2 change(VkImage image, VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
  return barrier;
}

void wait_for(VkCommandBuffer commands, const VkMemoryBarrier2* memory, const VkImageMemoryBarrier2* image) {
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.memoryBarrierCount = memory ? 1 : 0;
  info.pMemoryBarriers = memory;
  info.imageMemoryBarrierCount = image ? 1 : 0;
  info.pImageMemoryBarriers = image;
  vkCmdPipelineBarrier2(commands, &info);
}

VkSemaphore make_semaphore(VkDevice device) {
  const VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
  VkSemaphore semaphore = VK_NULL_HANDLE;
  check(vkCreateSemaphore(device, &info, nullptr, &semaphore), "creating a semaphore");
  return semaphore;
}

} // namespace

Presenter::Presenter(Device& device, const GlfwWindow& window)
    : device_(device), swapchain_(device, window), window_(window) {
  try {
    for (Presentation& presentation : presentations_) {
      VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
      pool.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
      pool.queueFamilyIndex = device.queue_family();
      check(vkCreateCommandPool(device.handle(), &pool, nullptr, &presentation.pool), "creating a command pool");
      VkCommandBufferAllocateInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
      commands.commandPool = presentation.pool;
      commands.commandBufferCount = 1;
      check(vkAllocateCommandBuffers(device.handle(), &commands, &presentation.commands), "allocating commands");
      presentation.acquired = make_semaphore(device.handle());
      VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
      fence.flags = VK_FENCE_CREATE_SIGNALED_BIT;
      check(vkCreateFence(device.handle(), &fence, nullptr, &presentation.done), "creating a fence");
    }
  } catch (...) {
    release();
    throw;
  }
}

Presenter::~Presenter() {
  wait();
  release();
}

void Presenter::wait() {
  const std::lock_guard lock(device_.queue_mutex());
  vkQueueWaitIdle(device_.queue()); // a lost device is told of by what is submitted next
}

bool Presenter::remake() {
  wait();
  if (!swapchain_.recreate()) return false;
  for (const VkSemaphore semaphore : drawn_) vkDestroySemaphore(device_.handle(), semaphore, nullptr);
  drawn_.clear();
  for (std::uint32_t i = 0; i < swapchain_.image_count(); ++i) drawn_.push_back(make_semaphore(device_.handle()));
  stale_ = false;
  return true;
}

bool Presenter::present(const Buffer& pixels, std::uint32_t width, std::uint32_t height, Overlay& overlay) {
  const glm::uvec2 size = window_.size();
  if (size.x == 0 || size.y == 0) return stale_ = true, false;
  if ((stale_ || swapchain_.image_count() == 0) && !remake()) return false;

  Presentation& presentation = presentations_[next_];
  check(vkWaitForFences(device_.handle(), 1, &presentation.done, VK_TRUE, ~std::uint64_t{0}),
        "waiting for an earlier picture");
  std::uint32_t image = 0;
  VkResult result = vkAcquireNextImageKHR(device_.handle(), swapchain_.handle(), kPatience, presentation.acquired,
                                          VK_NULL_HANDLE, &image);
  if (result == VK_NOT_READY || result == VK_TIMEOUT) return false;
  if (result == VK_SUCCESS || result == VK_SUBOPTIMAL_KHR) {
    stale_ = result == VK_SUBOPTIMAL_KHR;
    check(vkResetFences(device_.handle(), 1, &presentation.done), "resetting a fence");
    record(presentation, image, pixels, width, height, overlay);
    result = submit(presentation, image);
    next_ = (next_ + 1) % kPresentationsInFlight;
  }
  if (result == VK_SUBOPTIMAL_KHR || result == VK_ERROR_OUT_OF_DATE_KHR)
    stale_ = true;
  else if (result == VK_ERROR_SURFACE_LOST_KHR) {
    wait();
    swapchain_.recreate_surface();
    stale_ = true;
  } else
    check(result, "showing a picture");
  return result == VK_SUCCESS || result == VK_SUBOPTIMAL_KHR;
}

void Presenter::record(Presentation& presentation, std::uint32_t index, const Buffer& pixels, std::uint32_t width,
                       std::uint32_t height, Overlay& overlay) {
  check(vkResetCommandPool(device_.handle(), presentation.pool, 0), "resetting commands");
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(vkBeginCommandBuffer(presentation.commands, &begin), "recording commands");
  const VkImage image = swapchain_.image(index);
  const VkExtent2D extent = swapchain_.extent();

  VkMemoryBarrier2 written{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  written.srcStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
  written.srcAccessMask = VK_ACCESS_2_SHADER_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT;
  written.dstStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
  written.dstAccessMask = VK_ACCESS_2_TRANSFER_READ_BIT;
  // Waits for `acquired` in submit().
  VkImageMemoryBarrier2 filling = change(image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  filling.dstAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
  wait_for(presentation.commands, &written, &filling);

  // While the window changes its size the picture may still have the old one.
  if (width < extent.width || height < extent.height) {
    const VkClearColorValue black{};
    const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(presentation.commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &black, 1, &all);
    VkImageMemoryBarrier2 cleared =
        change(image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    cleared.srcAccessMask = cleared.dstAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
    wait_for(presentation.commands, nullptr, &cleared);
  }
  VkBufferImageCopy copy{};
  copy.bufferRowLength = width;
  copy.bufferImageHeight = height;
  copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  copy.imageExtent = {std::min(width, extent.width), std::min(height, extent.height), 1};
  if (copy.imageExtent.width > 0 && copy.imageExtent.height > 0)
    vkCmdCopyBufferToImage(presentation.commands, pixels.handle(), image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                           &copy);

  VkMemoryBarrier2 read{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2}; // before kernels write the next picture
  read.srcStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
  read.dstStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
  VkImageMemoryBarrier2 drawing =
      change(image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
  drawing.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
  drawing.dstStageMask = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
  drawing.dstAccessMask = VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT;
  wait_for(presentation.commands, &read, &drawing);

  VkRenderPassBeginInfo pass{VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO};
  pass.renderPass = swapchain_.pass();
  pass.framebuffer = swapchain_.framebuffer(index);
  pass.renderArea.extent = extent;
  vkCmdBeginRenderPass(presentation.commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
  overlay.draw(presentation.commands);
  vkCmdEndRenderPass(presentation.commands);
  check(vkEndCommandBuffer(presentation.commands), "recording commands");
}

VkResult Presenter::submit(Presentation& presentation, std::uint32_t image) {
  const VkPipelineStageFlags filling = VK_PIPELINE_STAGE_TRANSFER_BIT;
  VkSubmitInfo info{VK_STRUCTURE_TYPE_SUBMIT_INFO};
  info.waitSemaphoreCount = 1;
  info.pWaitSemaphores = &presentation.acquired;
  info.pWaitDstStageMask = &filling;
  info.commandBufferCount = 1;
  info.pCommandBuffers = &presentation.commands;
  info.signalSemaphoreCount = 1;
  info.pSignalSemaphores = &drawn_[image];
  const VkSwapchainKHR swapchain = swapchain_.handle();
  VkPresentInfoKHR present{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
  present.waitSemaphoreCount = 1;
  present.pWaitSemaphores = &drawn_[image];
  present.swapchainCount = 1;
  present.pSwapchains = &swapchain;
  present.pImageIndices = &image;
  const std::lock_guard lock(device_.queue_mutex());
  check(vkQueueSubmit(device_.queue(), 1, &info, presentation.done), "drawing the window");
  return vkQueuePresentKHR(device_.queue(), &present);
}

void Presenter::release() {
  for (const VkSemaphore semaphore : drawn_) vkDestroySemaphore(device_.handle(), semaphore, nullptr);
  for (const Presentation& presentation : presentations_) {
    vkDestroyFence(device_.handle(), presentation.done, nullptr);
    vkDestroySemaphore(device_.handle(), presentation.acquired, nullptr);
    vkDestroyCommandPool(device_.handle(), presentation.pool, nullptr);
  }
}

} // namespace wavepath
