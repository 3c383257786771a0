// Values of --aov that rays of their own find, apart from the samples (host/passes): they need no sums in the film.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace wavepath {

inline constexpr std::array<std::string_view, 8> kPassNames = {"node",    "material",  "cryptomatte", "depth0",
                                                               "normal0", "position0", "geometric",   "uv"};

inline bool is_pass(std::string_view aov) { return std::ranges::count(kPassNames, aov) > 0; }

} // namespace wavepath
