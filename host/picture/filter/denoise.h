// The filter of finished pictures: noise goes, edges stay, and so does the light as a whole.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "host/picture/filter/noisy_picture.h"

namespace wavepath {

// Host memory that it takes for a pixel, its picture included.
inline constexpr std::uint64_t kDenoiseBytesPerPixel = 256;

// The radiance of every pixel without its noise. Biased: what is smaller than the noise is lost. The same bits for any
// number of threads. The sum over the picture is that of `picture.color`, but for values that would be negative.
std::vector<glm::vec3> denoise(const NoisyPicture& picture);

} // namespace wavepath
