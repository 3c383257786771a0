// Files of formats whose readers in OpenImageIO trust lengths and counts, looked at before those are.
#pragma once

#include <string>

namespace wavepath {

// Photoshop: throws ImageError unless there are as many channels as the colour mode has, and every section ends within
// the file.
void check_photoshop(const std::string& path);

// DirectDraw surfaces: throws ImageError unless the file is as long as its first level takes.
void check_dds(const std::string& path);

// Windows bitmaps: likewise.
void check_bitmap(const std::string& path);

} // namespace wavepath
