// Intel Open Image Denoise, if the user has it: opened at run time, so that nothing depends on it.
#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/picture/filter/noisy_picture.h"

namespace wavepath {

// The library, once opened: throws Error if there is none. Early, so that no time is spent on rendering first.
void require_oidn();

// The radiance of every pixel as the library filters it, by light, albedo and normal. Throws Error.
std::vector<glm::vec3> denoise_by_oidn(const NoisyPicture& picture);

} // namespace wavepath
