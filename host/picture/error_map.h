// Shows the error of each pixel as a picture.
#pragma once

#include <vector>

#include "host/picture/picture.h"

namespace wavepath {

// Returns linear values, to be written without a tone curve: black for error 0, pale yellow from `brightest` on.
Picture error_map(std::uint32_t width, std::uint32_t height, const std::vector<float>& error, double brightest = 1.0);

} // namespace wavepath
