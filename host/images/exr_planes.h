// Channels of an OpenEXR file, one plane of floats each.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/images/image.h"

namespace wavepath {

// Of the first part, and of its first level where it has several.
struct ExrShape {
  std::uint32_t width = 0, height = 0; // of the data window: what is stored
  bool cropped = false;                // the data window is not the display window
  std::vector<std::string> channels;   // R G B A first, then by name
};

// Which channels to read; throws to refuse the file before memory is taken.
using ChooseChannels = std::function<std::vector<std::string>(const ExrShape&)>;

// As many planes as were chosen, in that order: width * height values, rows from the top. Halfs and whole numbers
// become floats. Throws ImageError; also for chosen channels that are subsampled, and for deep images.
std::vector<std::vector<float>> read_exr_planes(const std::string& path, const ChooseChannels& choose);

} // namespace wavepath
