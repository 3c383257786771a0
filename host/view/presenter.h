// Presents a buffer of pixels: copies it into the window's next image, draws the overlay over it, and shows it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/gpu/buffer.h"
#include "host/gpu/device.h"
#include "host/view/swapchain.h"

namespace wavepath {

class Overlay; // host/view/overlay.h

class Presenter {
public:
  Presenter(Device& device, const GlfwWindow& window);
  ~Presenter();
  Presenter(Presenter&&) = delete;

  const Swapchain& swapchain() const { return swapchain_; }

  // Shows `pixels`, words in the order of swapchain().bgra(), and `overlay` over them. What the device wrote to them
  // before is waited for, as is this copy by what the device writes to them later. False if nothing could be shown for
  // now: the window is minimised, just changed, or its display takes no picture; try again.
  bool present(const Buffer& pixels, std::uint32_t width, std::uint32_t height, Overlay& overlay);
  // Waits until the device has finished all work for the window; then `pixels` may be freed.
  void wait();

  static constexpr std::uint32_t kPresentationsInFlight = 2;

private:
  struct Presentation { // resources of one presentation
    VkCommandPool pool = VK_NULL_HANDLE;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VkSemaphore acquired = VK_NULL_HANDLE;
    VkFence done = VK_NULL_HANDLE;
  };

  bool remake();
  void record(Presentation& presentation, std::uint32_t image, const Buffer& pixels, std::uint32_t width,
              std::uint32_t height, Overlay& overlay);
  VkResult submit(Presentation& presentation, std::uint32_t image);
  void release();

  Device& device_;
  Swapchain swapchain_;
  bool stale_ = true; // the swapchain no longer fits the window
  const GlfwWindow& window_;
  std::array<Presentation, kPresentationsInFlight> presentations_;
  std::uint32_t next_ = 0;
  std::vector<VkSemaphore> drawn_; // for each image: signalled when it may be shown
};

} // namespace wavepath
