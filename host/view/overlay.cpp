#include "host/view/overlay.h"

#include <cmath>
#include <mutex>

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>

#include "host/gpu/commands.h"
#include "host/picture/tonemap.h"

namespace wavepath {
namespace {

constexpr float kFontPixels = 13.0f; // its built-in font is made of pixels, so that only whole multiples are sharp

void set_look(float scale, bool encodes) {
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 4.0f;
  style.FrameRounding = style.GrabRounding = 3.0f;
  style.WindowBorderSize = 0.0f;
  style.ItemSpacing = ImVec2(6.0f, 4.0f);
  style.Colors[ImGuiCol_WindowBg] = ImVec4(0.08f, 0.08f, 0.09f, 0.88f);
  style.Colors[ImGuiCol_PlotHistogram] = style.Colors[ImGuiCol_SliderGrabActive];
  style.ScaleAllSizes(scale);
  if (encodes)
    for (ImVec4& color : style.Colors)
      color = ImVec4(from_srgb(color.x), from_srgb(color.y), from_srgb(color.z), color.w);
  ImFontConfig font;
  font.SizePixels = kFontPixels * scale;
  ImGui::GetIO().Fonts->AddFontDefault(&font);
}

// From 1.90 on (Debian 13), Dear ImGui uploads with commands of its own.
void upload_font(Device& device) {
#if IMGUI_VERSION_NUM < 19000
  Commands commands(device);
  ImGui_ImplVulkan_CreateFontsTexture(commands.handle());
  commands.submit_and_wait();
  ImGui_ImplVulkan_DestroyFontUploadObjects();
#else
  const std::lock_guard lock(device.queue_mutex()); // kernels may be compiling, which ends in a dispatch
  ImGui_ImplVulkan_CreateFontsTexture();
#endif
}

} // namespace

Overlay::Overlay(Device& device, const GlfwWindow& window, const Swapchain& swapchain, std::uint32_t frames)
    : device_(device) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  try {
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = io.LogFilename = nullptr; // viewing a scene writes no files
    float scale_x = 1.0f, scale_y = 1.0f;
    glfwGetWindowContentScale(window.handle(), &scale_x, &scale_y);
    set_look(std::fmax(1.0f, std::round(scale_x)), swapchain.encodes());

    // One texture, the font.
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1};
    VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    pool.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
    pool.maxSets = 1;
    pool.poolSizeCount = 1;
    pool.pPoolSizes = &size;
    check(vkCreateDescriptorPool(device.handle(), &pool, nullptr, &pool_), "creating a descriptor pool");

    glfw_ = ImGui_ImplGlfw_InitForVulkan(window.handle(), true); // calls the window's own callbacks first
    ImGui_ImplVulkan_InitInfo info{};
    info.Instance = device.instance();
    info.PhysicalDevice = device.physical();
    info.Device = device.handle();
    info.QueueFamily = device.queue_family();
    info.Queue = device.queue();
    info.DescriptorPool = pool_;
    info.MinImageCount = info.ImageCount = frames; // sets of vertex buffers, used in turn
    info.CheckVkResultFn = [](VkResult result) { check(result, "drawing the panel"); };
    vulkan_ = ImGui_ImplVulkan_Init(&info, swapchain.pass());
    upload_font(device);
  } catch (...) {
    release();
    throw;
  }
}

Overlay::~Overlay() { release(); }

void Overlay::begin() {
  ImGui_ImplVulkan_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
}

void Overlay::end() { ImGui::Render(); }

void Overlay::draw(VkCommandBuffer commands) { ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands); }

bool Overlay::wants_pointer() const { return ImGui::GetIO().WantCaptureMouse; }

bool Overlay::wants_keys() const { return ImGui::GetIO().WantTextInput; }

void Overlay::release() {
  if (vulkan_) ImGui_ImplVulkan_Shutdown();
  if (glfw_) ImGui_ImplGlfw_Shutdown();
  vkDestroyDescriptorPool(device_.handle(), pool_, nullptr);
  ImGui::DestroyContext();
}

} // namespace wavepath
