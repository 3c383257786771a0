// Pictures of any format as linear planes of Rec. 709.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace wavepath {

struct LinearPicture {
  std::uint32_t width = 0, height = 0;
  std::vector<std::string> channels; // R, G, B, then those asked for besides
  std::vector<std::vector<float>> planes;
  bool display = false; // 8 or 16 bits, which were decoded
};

struct ReadRequest {
  // The file is read as an environment: a cube map becomes a lat-long map, and the data window must contain the display
  // window.
  bool environment = false;
  // Colours are light, which is not negative: those outside of Rec. 709 are clipped where they would become so.
  bool light = false;
  std::function<bool(const std::string&)> wanted;                       // channels besides colours; none if it is empty
  std::function<void(std::uint32_t width, std::uint32_t height)> check; // throws to refuse a size
};

// The picture within its display window. Colours are those of colour_channels.h, multiplied by alpha where the file
// says that they are not yet. Throws Error.
LinearPicture read_linear(const std::string& path, const ReadRequest& request);

} // namespace wavepath
