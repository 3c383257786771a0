// Reads scenes of Mitsuba 3.
#pragma once

#include <string>

#include "host/convert/described.h"

namespace wavepath::convert {

// Throws Error with file and line.
Description read_mitsuba(const std::string& path);

} // namespace wavepath::convert
