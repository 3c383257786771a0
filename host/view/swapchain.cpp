#include "host/view/swapchain.h"

#include <algorithm>
#include <array>

#include "host/base/error.h"

namespace wavepath {
namespace {

constexpr const char* kSurfaceRemedy = "choose another with --device, or use 'wavepath render'";

// Best first. The bytes that are copied in are sRGB-encoded, so that formats that encode once more come last.
constexpr std::array kFormats = {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_B8G8R8A8_SRGB,
                                 VK_FORMAT_R8G8B8A8_SRGB};

} // namespace

Swapchain::Swapchain(Device& device, const GlfwWindow& window) : device_(device), window_(window) {
  try {
    if (!device.rasterizes()) throw Error(device.info().name, "cannot draw in windows", kSurfaceRemedy);
    create_surface();
    choose_format();
    create_pass();
  } catch (...) {
    release();
    throw;
  }
}

Swapchain::~Swapchain() { release(); }

void Swapchain::create_surface() {
  check(glfwCreateWindowSurface(device_.instance(), window_.handle(), nullptr, &surface_), "preparing the window");
  VkBool32 presents = VK_FALSE;
  check(vkGetPhysicalDeviceSurfaceSupportKHR(device_.physical(), device_.queue_family(), surface_, &presents),
        "asking whether the device shows windows");
  VkSurfaceCapabilitiesKHR can{};
  if (presents)
    check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physical(), surface_, &can), "asking for the surface");
  if (!presents || !(can.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT))
    throw Error(device_.info().name, "cannot show pictures on this display", kSurfaceRemedy);
}

void Swapchain::choose_format() {
  std::uint32_t count = 0;
  check(vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical(), surface_, &count, nullptr), "listing formats");
  std::vector<VkSurfaceFormatKHR> formats(count);
  check(vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical(), surface_, &count, formats.data()), "listing formats");
  for (const VkFormat wanted : kFormats)
    for (const VkSurfaceFormatKHR& format : formats)
      if (format.format == wanted && format.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR) {
        format_ = format;
        return;
      }
  throw Error(device_.info().name, "shows no 8-bit sRGB pictures on this display", kSurfaceRemedy);
}

// Loads what was copied in and leaves it ready to be shown.
void Swapchain::create_pass() {
  VkAttachmentDescription attachment{};
  attachment.format = format_.format;
  attachment.samples = VK_SAMPLE_COUNT_1_BIT;
  attachment.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
  attachment.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  attachment.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  attachment.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  attachment.initialLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  attachment.finalLayout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR;
  const VkAttachmentReference color{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &color;
  VkRenderPassCreateInfo info{VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO};
  info.attachmentCount = 1;
  info.pAttachments = &attachment;
  info.subpassCount = 1;
  info.pSubpasses = &subpass;
  check(vkCreateRenderPass(device_.handle(), &info, nullptr, &pass_), "creating a render pass");
}

bool Swapchain::bgra() const {
  return format_.format == VK_FORMAT_B8G8R8A8_UNORM || format_.format == VK_FORMAT_B8G8R8A8_SRGB;
}

bool Swapchain::encodes() const {
  return format_.format == VK_FORMAT_B8G8R8A8_SRGB || format_.format == VK_FORMAT_R8G8B8A8_SRGB;
}

bool Swapchain::recreate() {
  const glm::uvec2 size = window_.size();
  VkSurfaceCapabilitiesKHR can{};
  const VkResult asked = vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physical(), surface_, &can);
  if (asked == VK_ERROR_SURFACE_LOST_KHR) return recreate_surface(), false;
  check(asked, "asking for the surface");
  const bool free = can.currentExtent.width == 0xffffffffu;
  const glm::uvec2 least(can.minImageExtent.width, can.minImageExtent.height),
      most(can.maxImageExtent.width, can.maxImageExtent.height);
  const glm::uvec2 fitting =
      free ? glm::clamp(size, least, most) : glm::uvec2(can.currentExtent.width, can.currentExtent.height);
  release_images();
  if (size.x == 0 || size.y == 0 || fitting.x == 0 || fitting.y == 0) return false;

  // The swapchain, which replaces the old one.
  VkSwapchainCreateInfoKHR info{VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
  info.surface = surface_;
  info.minImageCount = can.minImageCount + 1; // one more than the display holds, so that drawing need not wait
  if (can.maxImageCount > 0) info.minImageCount = std::min(info.minImageCount, can.maxImageCount);
  info.imageFormat = format_.format;
  info.imageColorSpace = format_.colorSpace;
  info.imageExtent = {fitting.x, fitting.y};
  info.imageArrayLayers = 1;
  info.imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  info.imageSharingMode = VK_SHARING_MODE_EXCLUSIVE;
  info.preTransform = can.currentTransform;
  const bool opaque = can.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
  info.compositeAlpha = opaque ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
  info.presentMode = VK_PRESENT_MODE_FIFO_KHR; // the only one that every driver has; never faster than the display
  info.clipped = VK_TRUE;
  info.oldSwapchain = swapchain_;
  VkSwapchainKHR made = VK_NULL_HANDLE;
  const VkResult result = vkCreateSwapchainKHR(device_.handle(), &info, nullptr, &made);
  vkDestroySwapchainKHR(device_.handle(), swapchain_, nullptr);
  swapchain_ = made;
  if (result == VK_ERROR_SURFACE_LOST_KHR) return recreate_surface(), false;
  check(result, "creating a swapchain");
  extent_ = info.imageExtent;

  // A view and a framebuffer for each image.
  std::uint32_t count = 0;
  check(vkGetSwapchainImagesKHR(device_.handle(), swapchain_, &count, nullptr), "listing the window's images");
  images_.resize(count);
  check(vkGetSwapchainImagesKHR(device_.handle(), swapchain_, &count, images_.data()), "listing the window's images");
  for (const VkImage image : images_) {
    VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    view.image = image;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = format_.format;
    view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    check(vkCreateImageView(device_.handle(), &view, nullptr, &views_.emplace_back()), "creating an image view");
    VkFramebufferCreateInfo frame{VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO};
    frame.renderPass = pass_;
    frame.attachmentCount = 1;
    frame.pAttachments = &views_.back();
    frame.width = extent_.width;
    frame.height = extent_.height;
    frame.layers = 1;
    check(vkCreateFramebuffer(device_.handle(), &frame, nullptr, &framebuffers_.emplace_back()),
          "creating a framebuffer");
  }
  return true;
}

void Swapchain::recreate_surface() {
  release_images();
  vkDestroySwapchainKHR(device_.handle(), swapchain_, nullptr);
  swapchain_ = VK_NULL_HANDLE;
  vkDestroySurfaceKHR(device_.instance(), surface_, nullptr);
  surface_ = VK_NULL_HANDLE;
  create_surface();
}

void Swapchain::release_images() {
  for (const VkFramebuffer framebuffer : framebuffers_) vkDestroyFramebuffer(device_.handle(), framebuffer, nullptr);
  for (const VkImageView view : views_) vkDestroyImageView(device_.handle(), view, nullptr);
  framebuffers_.clear(), views_.clear(), images_.clear();
}

void Swapchain::release() {
  release_images();
  vkDestroySwapchainKHR(device_.handle(), swapchain_, nullptr);
  vkDestroyRenderPass(device_.handle(), pass_, nullptr);
  if (surface_) vkDestroySurfaceKHR(device_.instance(), surface_, nullptr);
}

} // namespace wavepath
