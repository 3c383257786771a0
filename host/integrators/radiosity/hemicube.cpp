#include "host/integrators/radiosity/hemicube.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace wavepath {

std::uint32_t hemicube_side(std::uint64_t pixels) {
  const auto half = static_cast<std::uint32_t>(std::lround(0.5 * std::sqrt(static_cast<double>(pixels) / 3.0)));
  return 2 * std::clamp(half, 4u, 1024u);
}

// Up to a factor: z / (x^2 + y^2 + z^2)^2, with a face at distance 1 (equations 11 and 12).
std::vector<double> delta_form_factors(std::uint32_t side) {
  std::vector<double> factors;
  factors.reserve(std::size_t{3} * side * side);
  const double step = 2.0 / side;
  for (std::uint32_t row = 0; row < side; ++row)
    for (std::uint32_t column = 0; column < side; ++column) {
      const double x = (column + 0.5) * step - 1.0, y = (row + 0.5) * step - 1.0, d = x * x + y * y + 1.0;
      factors.push_back(1.0 / (d * d));
    }
  for (int face = 0; face < 4; ++face)
    for (std::uint32_t row = 0; row < side / 2; ++row)
      for (std::uint32_t column = 0; column < side; ++column) {
        const double y = (column + 0.5) * step - 1.0, z = (row + 0.5) * step, d = y * y + z * z + 1.0;
        factors.push_back(z / (d * d));
      }
  const double sum = std::accumulate(factors.begin(), factors.end(), 0.0);
  for (double& factor : factors) factor /= sum;
  return factors;
}

} // namespace wavepath
