// A picture: named channels of floats.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace wavepath {

// One EXR channel: row-major from the top left, width * height values.
struct Channel {
  std::string name; // "R", "albedo.R", "Z", ...
  std::vector<float> values;
};

struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<Channel> channels; // R G B A first
  bool display = false;          // read from 8 or 16 bits that a display shows
};

} // namespace wavepath
