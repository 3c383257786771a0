// Undoes Zstandard and zlib.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace wavepath::ktx {

// Exactly `length` bytes. Throws FileError if the data are damaged or hold another number.
std::vector<std::uint8_t> inflate_zstd(std::span<const std::uint8_t> data, std::size_t length);
std::vector<std::uint8_t> inflate_zlib(std::span<const std::uint8_t> data, std::size_t length);

} // namespace wavepath::ktx
