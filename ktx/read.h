// Reads KTX2 files: container, supercompression, and every payload that a 2D texture may have.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "ktx/picture.h"

namespace wavepath::ktx {

// Called with the size that the header states, before memory is taken for texels; it throws to refuse.
using CheckSize = std::function<void(std::uint32_t width, std::uint32_t height)>;

// Level 0 of the picture. Smaller levels are passed over. Throws FileError, or what `check` throws.
Picture read(std::span<const std::uint8_t> file, const CheckSize& check);

} // namespace wavepath::ktx
