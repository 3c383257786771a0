// The images of a window: made for its size, made again when that or the surface is no longer theirs.
#pragma once

#include <cstdint>
#include <vector>

#include "host/gpu/device.h"
#include "host/view/glfw.h"

namespace wavepath {

class Swapchain {
public:
  // Makes a swapchain without images, until recreate(). Throws Error if the device cannot show anything in this window.
  Swapchain(Device& device, const GlfwWindow& window);
  ~Swapchain();
  Swapchain(Swapchain&&) = delete;

  // Makes the images in the present size of the window. The queue must be idle. Returns false if the window has no size
  // or cannot be shown.
  bool recreate();
  // Makes the surface again after VK_ERROR_SURFACE_LOST_KHR. Call recreate() afterwards.
  void recreate_surface();

  VkSwapchainKHR handle() const { return swapchain_; }
  VkRenderPass pass() const { return pass_; } // draws over what an image holds
  VkExtent2D extent() const { return extent_; }
  std::uint32_t image_count() const { return static_cast<std::uint32_t>(images_.size()); }
  VkImage image(std::uint32_t i) const { return images_[i]; }
  VkFramebuffer framebuffer(std::uint32_t i) const { return framebuffers_[i]; }
  bool bgra() const;
  // Stored bytes are what is shown in any case; but colours that shaders write are encoded on their way.
  bool encodes() const;

private:
  void create_surface();
  void choose_format();
  void create_pass();
  void release_images();
  void release();

  Device& device_;
  const GlfwWindow& window_;
  VkSurfaceKHR surface_ = VK_NULL_HANDLE;
  VkSurfaceFormatKHR format_{};
  VkRenderPass pass_ = VK_NULL_HANDLE;
  VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
  VkExtent2D extent_{};
  std::vector<VkImage> images_;
  std::vector<VkImageView> views_;
  std::vector<VkFramebuffer> framebuffers_;
};

} // namespace wavepath
