// How the samples of a picture are dealt to devices of different speed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace wavepath {

// Counts of samples proportional to `speeds` (samples a second, of which one at least is positive), by largest
// remainders: they add up to `count`.
std::vector<std::uint32_t> deal(std::uint32_t count, std::span<const double> speeds);

} // namespace wavepath
