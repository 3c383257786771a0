// Cache files: derived data kept from run to run. A file that is missing, damaged, truncated, written by something else
// or not writable only costs time: no function here throws because of the state of the disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace wavepath {

// The folder of the cache files: $WAVEPATH_CACHE, else $XDG_CACHE_HOME/wavepath, else ~/.cache/wavepath. Empty if
// WAVEPATH_CACHE is "off", or if there is no home.
std::filesystem::path cache_folder();

// The data written with the same `key`; empty if there is no valid file.
std::vector<std::uint8_t> read_cache_file(const std::filesystem::path& path, std::uint64_t key);

// Replaces the file atomically; creates its folder with access for the user only. Returns false on failure.
bool write_cache_file(const std::filesystem::path& path, std::uint64_t key, std::span<const std::uint8_t> data);

} // namespace wavepath
