// Pictures to and from files: EXR and HDR linear, PNG and JPG tonemapped; written whole or not at all.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "host/picture/files/exr.h"
#include "host/picture/picture.h"
#include "host/picture/picture_format.h"
#include "host/picture/tonemap.h"

namespace wavepath {

struct WriteOptions {
  bool half = false;                    // EXR: 16-bit floats
  std::optional<double> exposure = 0.0; // PNG, JPG: radiance is scaled by 2^exposure; empty = auto_exposure()
  Tonemap tonemap = Tonemap::neutral;
};

// Prefix of the channels that hold the filtered picture, if there is one: "denoised.R" and so on.
inline constexpr const char* kShownPrefix = "denoised.";

// The channels that files of three channels show: the filtered picture where there is one, else R G B.
std::array<const Channel*, 3> shown_channels(const Picture& picture);
// A picture whose R G B are these channels.
Picture shown_picture(const Picture& picture);

// Writes the format that the extension of `path` names: all channels to EXR, those shown to the others. Returns how
// many values were clamped because the format ends before them. Throws Error; then `path` is as it was.
std::uint64_t write_picture(const std::string& path, const Picture& picture, const PictureInfo& info,
                            const WriteOptions& options);

// The exposure with which a picture is written to a PNG or JPG.
double exposure_of(const Picture& picture, const WriteOptions& options);

// Linear values of a file of any format that host/codecs/linear_picture.h reads, R G B first; grey is spread to three
// channels. Throws Error.
Picture read_picture(const std::string& path);

// The same, R G B alone, as light: without values that other primaries would make negative.
Picture read_light(const std::string& path);

// The channel of that name, or null.
const Channel* find_channel(const Picture& picture, const std::string& name);

} // namespace wavepath
