// Intel Open Image Denoise. The library is opened at run time if the user has it, so that nothing depends on it.
#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/picture/filter/noisy_picture.h"

namespace wavepath {

// Opens the library. Throws Error if there is none. Called early, before time is spent on rendering.
void require_oidn();

// The radiance of every pixel, filtered by the library with the help of albedo and normal. Throws Error.
std::vector<glm::vec3> denoise_by_oidn(const NoisyPicture& picture);

} // namespace wavepath
