// The format of a picture file by its first bytes, and by its name where those say nothing.
#pragma once

#include <string>

namespace wavepath {

// As OpenImageIO names it, but for png, jpeg and webp, which are decoded without it; null for what is read by neither.
// Throws Error if the file cannot be read.
const char* stored_format(const std::string& path);

// What can be read, for messages and help.
inline constexpr const char* kReadablePictures =
    "EXR, HDR, PNG, JPEG, WebP, TIFF, TGA, BMP, DDS, PSD, JPEG 2000, HEIF, AVIF, PFM or PNM";

} // namespace wavepath
