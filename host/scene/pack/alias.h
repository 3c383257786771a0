// Alias tables: constant-time picks with given probabilities (Walker 1977; construction by Vose 1991).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace wavepath {

// Pick column i = floor(u * n); take i if fract(u * n) < threshold[i], else alias[i].
struct AliasTable {
  std::vector<float> threshold;
  std::vector<std::uint32_t> alias;
  double total = 0.0; // of the weights
};

// `weights`: finite, none negative, at most 2^32 - 1 of them. Empty if they sum to zero. A weight of zero is never
// picked.
AliasTable build_alias_table(std::span<const double> weights);

// The probability of every index as the stored thresholds give it. The sum differs from 1 by about 1e-12 at most.
std::vector<double> alias_probabilities(const AliasTable& table);

} // namespace wavepath
