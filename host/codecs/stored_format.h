// The format of a picture file by its first bytes, and by its name where those say nothing.
#pragma once

#include <string>

namespace wavepath {

// Name of a file's format: png, jpeg and webp, which are decoded without OpenImageIO, or OpenImageIO's name; null if
// the file cannot be decoded. Throws Error if the file cannot be read.
const char* stored_format(const std::string& path);

// List of readable formats, for messages and help.
inline constexpr const char* kReadablePictures =
    "EXR, HDR, PNG, JPEG, WebP, TIFF, TGA, BMP, DDS, PSD, JPEG 2000, HEIF, AVIF, PFM or PNM";

} // namespace wavepath
