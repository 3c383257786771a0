// Noise filter of finished pictures: keeps edges and the total light.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "host/picture/filter/noisy_picture.h"

namespace wavepath {

// Bytes of host memory that the filter needs for each pixel, the picture included.
inline constexpr std::uint64_t kDenoiseBytesPerPixel = 256;

// Returns the filtered radiance of every pixel. It is biased: detail smaller than the noise is lost. Its bits do not
// depend on the number of threads. Its sum over the picture is that of `picture.color`, except for values that would be
// negative.
std::vector<glm::vec3> denoise(const NoisyPicture& picture);

} // namespace wavepath
