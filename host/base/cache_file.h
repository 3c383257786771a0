// Files of derived data, kept from run to run. One that is missing, damaged, cut short, of another origin or impossible to
// write costs time and nothing else: no function here throws for what it finds on the disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace wavepath {

// Where they go: $WAVEPATH_CACHE, else $XDG_CACHE_HOME/wavepath, else ~/.cache/wavepath. Empty if WAVEPATH_CACHE is "off", or
// if there is no home.
std::filesystem::path cache_folder();

// The data written with the same `key`; empty if there are none that are sound.
std::vector<std::uint8_t> read_cache_file(const std::filesystem::path& path, std::uint64_t key);

// Replaces the file, whole or not at all, creating its folder for the user alone. False if it cannot be.
bool write_cache_file(const std::filesystem::path& path, std::uint64_t key, std::span<const std::uint8_t> data);

} // namespace wavepath
