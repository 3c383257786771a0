// The version of these headers, and that of the library.
#pragma once

#include <wavepath/export.h>

#define WAVEPATH_VERSION_MAJOR 0
#define WAVEPATH_VERSION_MINOR 1
#define WAVEPATH_VERSION_PATCH 0

namespace wavepath_v0 {

// "0.1.0"
WAVEPATH_API const char* version();

} // namespace wavepath_v0
