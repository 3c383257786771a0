// Photoshop files, looked at before OpenImageIO does: its reader trusts their lengths and counts.
#pragma once

#include <string>

namespace wavepath {

// Throws ImageError unless there are as many channels as the colour mode has, and every section ends within the file.
void check_photoshop(const std::string& path);

} // namespace wavepath
