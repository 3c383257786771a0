// The line between the halves of a split picture: drawn with the names of both, and dragged by the pointer.
#pragma once

#include <cstdint>
#include <string>

#include "host/view/glfw.h"

namespace wavepath {

class Divider {
public:
  // Takes a left drag that began on the line out of the input, and moves the line to the pointer. `at`: its position,
  // as a fraction of the picture's width. `held`: a button is still down.
  void take(Input& input, bool held, std::uint32_t width, double& at);

private:
  bool in_drag_ = false, grabbed_ = false;
};

// Over the picture, under the panel; between begin() and end() of the overlay.
void draw_divider(double at, const std::string& left, const std::string& right);

} // namespace wavepath
