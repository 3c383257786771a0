#include "host/library/field_value.h"

#include <cmath>

#include <fmt/format.h>

#include "host/base/error.h"

namespace wavepath_v0 {

void check_value(const std::string& field, const std::vector<double>& value, std::size_t count) {
  if (value.size() != count)
    throw wavepath::UsageError(field, fmt::format("has {} values, not {}", count, value.size()),
                               fmt::format("give {}", count == 1 ? "a number" : "as many numbers"));
  for (const double number : value)
    if (!std::isfinite(number))
      throw wavepath::UsageError(field, "cannot be a number that is not finite", "give finite numbers");
}

} // namespace wavepath_v0
