// Values that fields of materials and lights are set to.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace wavepath_v0 {

// Throws UsageError unless there are `count` values, all finite.
void check_value(const std::string& field, const std::vector<double>& value, std::size_t count);

} // namespace wavepath_v0
