// Light cookies: pictures that lights are projected through.
#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/gpu/device.h"

namespace wavepath {

// Reads a cookie, in the layout of kernels/hybrid/shadows/cookie_types.h; no picture if `path` is empty. Throws Error
// if it cannot be read, if the device cannot hold it, or if light would be negative or infinite.
std::vector<glm::vec4> read_cookie(const std::string& path, const DeviceInfo& device);

} // namespace wavepath
