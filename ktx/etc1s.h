// ETC1S pictures compressed by BasisLZ: appendices "BasisLZ/ETC1S Bitstream" and "BasisLZ Global Data" of KTX 2.0.
#pragma once

#include <cstdint>

#include "ktx/container.h"

namespace wavepath::ktx {

// Writes level 0 as RGBA8. Throws FileError.
void decode_etc1s(const Container& container, std::uint8_t* rgba);

} // namespace wavepath::ktx
