// Layers of an EXR: what other programs call a channel, and which channels stand in one part.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/picture/files/write_options.h"
#include "host/picture/picture.h"

namespace wavepath {

// The name under which a channel is written.
std::string written_name(LayerNames names, const std::string& channel);

// Channels that may lose precision where a compression does: colours and alpha. All others are data.
bool is_colour(const std::string& channel);

struct PicturePart {
  std::string name;                  // empty = the file has this part alone
  std::vector<std::size_t> channels; // of the picture
  bool sums = false;                 // holds the exact sums as well
  Compression compression = Compression::zip;
};

// The parts in which a picture is written. One, unless the options ask for one a layer, or the compression is lossy and
// there is data, which then stands apart and loses nothing.
std::vector<PicturePart> parts_of(const Picture& picture, bool has_sums, const WriteOptions& options);

} // namespace wavepath
