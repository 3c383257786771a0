#include "host/render/multi_device/deal.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace wavepath {

std::vector<std::uint32_t> deal(std::uint32_t count, std::span<const double> speeds) {
  const double sum = std::accumulate(speeds.begin(), speeds.end(), 0.0);
  std::vector<std::uint32_t> counts;
  std::vector<double> remainders;
  for (const double speed : speeds) {
    const double exact = count * (speed / sum);
    counts.push_back(static_cast<std::uint32_t>(exact));
    remainders.push_back(exact - std::floor(exact));
  }
  for (auto left = count - std::accumulate(counts.begin(), counts.end(), 0u); left > 0; --left) {
    const auto largest = static_cast<std::size_t>(std::ranges::max_element(remainders) - remainders.begin());
    ++counts[largest];
    remainders[largest] = -1.0;
  }
  return counts;
}

} // namespace wavepath
