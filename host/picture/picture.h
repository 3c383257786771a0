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

// The part of a picture that a film or a picture holds: its left top corner, and the size of the whole picture. A width
// of 0: it is the whole picture.
struct PicturePlace {
  std::uint32_t left = 0, top = 0, whole_width = 0, whole_height = 0;
  bool operator==(const PicturePlace&) const = default;
};

struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<Channel> channels; // R G B A first
  bool display = false;          // true if read from a file of 8 or 16 bits with display values
  // Header attributes of an EXR that explain its channels: name, text.
  std::vector<std::pair<std::string, std::string>> texts{};
  PicturePlace place{};
};

} // namespace wavepath
