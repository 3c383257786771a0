// Distributes the samples of a picture among devices of different speed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace wavepath {

// Numbers of samples for each device, in proportion to `speeds`, which add up to `count` (largest remainders).
// `speeds`: samples a second, at least one of them positive.
std::vector<std::uint32_t> deal(std::uint32_t count, std::span<const double> speeds);

} // namespace wavepath
