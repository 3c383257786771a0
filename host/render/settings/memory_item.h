// Memory that a render needs for one purpose.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace wavepath {

enum class MemoryLocation { device, host, both };

struct MemoryItem {
  std::string_view name;
  std::uint64_t bytes = 0; // in each of the locations
  MemoryLocation location = MemoryLocation::device;
};

} // namespace wavepath
