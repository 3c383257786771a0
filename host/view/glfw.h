// GLFW: opened once, its errors as Error, and a window that collects the input since it was last read.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

#include <GLFW/glfw3.h>
#include <glm/glm.hpp>

namespace wavepath {

// Throws Error where there is no display, or none that can be opened.
void open_glfw();

struct KeyPress {
  int key = 0, modifiers = 0; // GLFW's
};

// The input since it was last taken. Positions are pixels of the picture from its top left corner.
struct Input {
  std::vector<KeyPress> keys;
  glm::dvec2 drag_left{0.0}, drag_middle{0.0}, drag_right{0.0}; // way of the pointer with that button held
  int modifiers = 0;                                            // held while dragging or scrolling
  double scroll = 0.0;
  bool double_click = false, control_click = false;
  glm::dvec2 pointer{0.0};
};

class GlfwWindow {
public:
  GlfwWindow(const std::string& title, std::uint32_t width, std::uint32_t height);
  ~GlfwWindow();
  GlfwWindow(GlfwWindow&&) = delete;

  GLFWwindow* handle() const { return window_; }
  // Size in pixels; zero while minimised.
  glm::uvec2 size() const;
  bool should_close() const { return glfwWindowShouldClose(window_) != 0; }
  bool held(int key) const { return glfwGetKey(window_, key) == GLFW_PRESS; }
  glm::dvec2 pointer() const { return input_.pointer; }
  bool dragging() const { return dragging_ >= 0; }
  // True if anything happened since the last call that may change the contents of the window.
  bool take_events();
  Input take_input();
  // Ends a drag, because the pointer is over the panel.
  void drop_pointer() { dragging_ = -1; }

private:
  static GlfwWindow& of(GLFWwindow* window) { return *static_cast<GlfwWindow*>(glfwGetWindowUserPointer(window)); }
  void install_callbacks();
  void on_button(int button, int action, int modifiers);
  void on_move(double x, double y);
  double pixels_per_unit() const; // pixels to a screen coordinate

  GLFWwindow* window_ = nullptr;
  Input input_;
  bool events_ = true;
  int dragging_ = -1; // button, or none
  double last_click_ = -1.0;
  glm::dvec2 last_click_at_{0.0};
};

} // namespace wavepath
