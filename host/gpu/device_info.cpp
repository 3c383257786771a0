#include "host/gpu/device_info.h"

#include <algorithm>
#include <array>

namespace wavepath {

bool draws_slowly(const std::string& device_name) {
  constexpr std::array kNames = {"H100", "H20", "H800"}; // "H20": the H200 and the GH200, too
  return std::ranges::any_of(kNames, [&](const char* name) { return device_name.find(name) != std::string::npos; });
}

} // namespace wavepath
