// Reads scenes of pbrt-v4.
#pragma once

#include <string>

#include "host/convert/described.h"

namespace wavepath::convert {

// Throws Error with file and line.
Description read_pbrt(const std::string& path);

} // namespace wavepath::convert
