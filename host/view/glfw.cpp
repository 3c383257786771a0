#include "host/view/glfw.h"

#include <cstdlib>
#include <utility>

#include <fmt/format.h>

#include "host/base/error.h"

namespace wavepath {
namespace {

constexpr const char* kDisplayRemedy = "use 'wavepath render', or a virtual display: xvfb-run -a wavepath view ...";
constexpr double kDoubleClick = 0.4;       // seconds between its clicks at most,
constexpr double kDoubleClickDistance = 4; // and pixels

bool is_set(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

std::string last_error() {
  const char* text = nullptr;
  return glfwGetError(&text) != GLFW_NO_ERROR && text ? text : "no reason given";
}

} // namespace

void open_glfw() {
  if (!is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY"))
    throw Error("view", "there is no display (DISPLAY and WAYLAND_DISPLAY are not set)", kDisplayRemedy);
#if GLFW_VERSION_MAJOR > 3 || GLFW_VERSION_MINOR >= 4
  // Or it asks for a Wayland display that nobody named, whose library then writes an error of its own.
  if (!is_set("WAYLAND_DISPLAY")) glfwInitHint(GLFW_PLATFORM, GLFW_PLATFORM_X11);
#endif
  if (!glfwInit()) throw Error("view", fmt::format("the display cannot be opened ({})", last_error()), kDisplayRemedy);
  std::atexit(glfwTerminate);
  if (!glfwVulkanSupported())
    throw Error("view", "there is no Vulkan for windows", "install libvulkan1 and a driver, or use 'wavepath render'");
}

GlfwWindow::GlfwWindow(const std::string& title, std::uint32_t width, std::uint32_t height) {
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  window_ = glfwCreateWindow(static_cast<int>(width), static_cast<int>(height), title.c_str(), nullptr, nullptr);
  if (!window_) throw Error("view", fmt::format("a window cannot be opened ({})", last_error()), kDisplayRemedy);
  glfwSetWindowUserPointer(window_, this);
  install_callbacks();
}

GlfwWindow::~GlfwWindow() { glfwDestroyWindow(window_); }

void GlfwWindow::install_callbacks() {
  glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int, int action, int modifiers) {
    of(w).events_ = true;
    if (action == GLFW_PRESS) of(w).input_.keys.push_back({key, modifiers});
  });
  glfwSetCharCallback(window_, [](GLFWwindow* w, unsigned) { of(w).events_ = true; });
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int button, int action, int modifiers) {
    of(w).on_button(button, action, modifiers);
  });
  glfwSetCursorPosCallback(window_, [](GLFWwindow* w, double x, double y) { of(w).on_move(x, y); });
  glfwSetScrollCallback(window_, [](GLFWwindow* w, double, double y) {
    of(w).events_ = true;
    of(w).input_.scroll += y;
  });
  const auto shows = [](GLFWwindow* w, int) { of(w).events_ = true; };
  glfwSetWindowFocusCallback(window_, shows);
  glfwSetWindowIconifyCallback(window_, shows);
  glfwSetCursorEnterCallback(window_, shows);
  glfwSetWindowRefreshCallback(window_, [](GLFWwindow* w) { of(w).events_ = true; });
  glfwSetWindowCloseCallback(window_, [](GLFWwindow* w) { of(w).events_ = true; });
  glfwSetFramebufferSizeCallback(window_, [](GLFWwindow* w, int, int) { of(w).events_ = true; });
}

double GlfwWindow::pixels_per_unit() const {
  int units = 0, pixels = 0, height = 0;
  glfwGetWindowSize(window_, &units, &height);
  glfwGetFramebufferSize(window_, &pixels, &height);
  return units > 0 ? static_cast<double>(pixels) / units : 1.0;
}

void GlfwWindow::on_button(int button, int action, int modifiers) {
  events_ = true;
  if (action == GLFW_RELEASE) {
    if (dragging_ == button) dragging_ = -1;
    return;
  }
  dragging_ = button;
  input_.modifiers = modifiers;
  if (button != GLFW_MOUSE_BUTTON_LEFT) return;
  const double now = glfwGetTime();
  const bool near = glm::length(input_.pointer - last_click_at_) <= kDoubleClickDistance;
  if (modifiers & GLFW_MOD_CONTROL) input_.control_click = true;
  if (last_click_ >= 0.0 && now - last_click_ < kDoubleClick && near) input_.double_click = true;
  last_click_ = input_.double_click ? -1.0 : now;
  last_click_at_ = input_.pointer;
}

void GlfwWindow::on_move(double x, double y) {
  events_ = true;
  const glm::dvec2 position = pixels_per_unit() * glm::dvec2(x, y), moved = position - input_.pointer;
  input_.pointer = position;
  if (dragging_ == GLFW_MOUSE_BUTTON_LEFT) input_.drag_left += moved;
  if (dragging_ == GLFW_MOUSE_BUTTON_MIDDLE) input_.drag_middle += moved;
  if (dragging_ == GLFW_MOUSE_BUTTON_RIGHT) input_.drag_right += moved;
}

glm::uvec2 GlfwWindow::size() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  // A window that nobody sees keeps its size on most systems.
  const bool shown = !glfwGetWindowAttrib(window_, GLFW_ICONIFIED) && glfwGetWindowAttrib(window_, GLFW_VISIBLE);
  return shown ? glm::uvec2(width, height) : glm::uvec2(0);
}

bool GlfwWindow::take_events() { return std::exchange(events_, false); }

Input GlfwWindow::take_input() {
  Input taken = std::move(input_);
  input_ = {};
  input_.pointer = taken.pointer;
  input_.modifiers = taken.modifiers;
  return taken;
}

} // namespace wavepath
