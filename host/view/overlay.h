// Dear ImGui in our window: its context, its backends for GLFW and Vulkan, and its style.
#pragma once

#include <vulkan/vulkan.h>

#include "host/gpu/device.h"
#include "host/view/glfw.h"
#include "host/view/swapchain.h"

namespace wavepath {

class Overlay {
public:
  // `frames`: presentations that may be in flight at once.
  Overlay(Device& device, const GlfwWindow& window, const Swapchain& swapchain, std::uint32_t frames);
  ~Overlay();
  Overlay(Overlay&&) = delete;

  // Between them the widgets are made.
  void begin();
  void end();
  // Draws what was made last. Call inside the swapchain's pass.
  void draw(VkCommandBuffer commands);

  // True if pointer, or keys, belong to the widgets.
  bool wants_pointer() const;
  bool wants_keys() const;

private:
  void release();

  Device& device_;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  bool glfw_ = false, vulkan_ = false; // whether the backends are open
};

} // namespace wavepath
