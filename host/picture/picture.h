// A picture: named channels of floats.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace wavepath {

// A channel: width * height values, row-major from the top left.
struct Channel {
  std::string name; // "R", "albedo.R", "Z", ...
  std::vector<float> values;
};

struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<Channel> channels; // R G B A first
  bool display = false;          // true if read from a file of 8 or 16 bits with display values
  // Header attributes of an EXR that explain its channels: name, text.
  std::vector<std::pair<std::string, std::string>> texts{};
};

} // namespace wavepath
