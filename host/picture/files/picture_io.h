// Reads and writes picture files: EXR and HDR linear, PNG and JPG with a tone curve. A file is written as a whole or
// not at all.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "host/picture/files/exr.h"
#include "host/picture/files/write_options.h"
#include "host/picture/picture.h"
#include "host/picture/picture_format.h"

namespace wavepath {

// Prefix of the channels of the filtered picture, if there is one: "denoised.R" and so on.
inline constexpr const char* kShownPrefix = "denoised.";

// The channels that a file of three channels gets: the filtered picture if there is one, else R G B.
std::array<const Channel*, 3> shown_channels(const Picture& picture);
// The channel A; null where all is opaque.
const Channel* alpha_of(const Picture& picture);
// A picture whose R G B are shown_channels().
Picture shown_picture(const Picture& picture);

// Writes the format that the extension of `path` names: all channels to EXR, shown_channels() to the others. Returns
// the number of values that were clamped to the range of the format. On failure throws Error and leaves `path` as it
// was.
std::uint64_t write_picture(const std::string& path, const Picture& picture, const PictureInfo& info,
                            const WriteOptions& options);

// Exposure, in stops, with which a picture is written to PNG or JPG.
double exposure_of(const Picture& picture, const WriteOptions& options);

// Reads linear values from a file of any format that host/codecs/linear_picture.h supports; R G B come first, and grey
// is copied to all three. Throws Error.
Picture read_picture(const std::string& path);

// The same for light: R G B only, without the negative values that other primaries may give.
Picture read_light(const std::string& path);

// The channel of that name; null if there is none.
const Channel* find_channel(const Picture& picture, const std::string& name);

} // namespace wavepath
