// Finds the colour channels of a file.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "host/codecs/picture_module.h"

namespace wavepath {

struct ColourChannels {
  std::size_t part = 0;
  std::array<std::size_t, 3> rgb{}; // three times the same where the picture is grey
  bool grey() const { return rgb[0] == rgb[1]; }
};

// R, G and B of the first part that has them, in any case, or as words; else luminance, Y or L or what a format of one
// channel calls I; else R, G and B of a layer, "NAME.R": of one whose name says that it is the whole picture if there
// is one, of the first otherwise. Nothing where no channel is a colour: depth and alpha are none.
std::optional<ColourChannels> colour_channels(const std::vector<StoredPart>& parts);

// "R, G, depth.Z": of all parts, for messages.
std::string channel_list(const std::vector<StoredPart>& parts);

} // namespace wavepath
