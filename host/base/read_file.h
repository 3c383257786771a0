// Reads regular files or parts of them, so that callers can refuse a file by its size before they allocate anything for
// it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

namespace wavepath {

// Bytes in the file; nothing if it does not exist, cannot be examined, or is a folder, a device or a pipe.
std::optional<std::uint64_t> regular_file_size(const std::filesystem::path& path);

// Fills `out` with the bytes from `offset` on; false if the file cannot be opened or ends before that.
bool read_file(const std::filesystem::path& path, std::uint64_t offset, std::span<std::uint8_t> out);

// The contents of a regular file; empty if it cannot be read. Throws Error if it does not fit into memory.
std::optional<std::vector<std::uint8_t>> read_whole_file(const std::filesystem::path& path);

} // namespace wavepath
