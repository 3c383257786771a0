// Data that zlib compressed, with a bound on what it may become.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace wavepath::convert {

// gzip and zlib streams. `path`: for messages. Throws Error.
std::vector<std::uint8_t> inflated(const std::string& path, std::span<const std::uint8_t> packed);

} // namespace wavepath::convert
