// Vose's construction in double precision, carrying the rounding of each stored threshold on; see alias.h.
#include "host/scene/pack/alias.h"

namespace wavepath {

AliasTable build_alias_table(std::span<const double> weights) {
  AliasTable table;
  for (const double weight : weights) table.total += weight;
  if (!(table.total > 0.0)) return table;

  const std::size_t n = weights.size();
  table.threshold.resize(n);
  table.alias.resize(n);
  // Columns still to be filled: the small ones stack up from the front of `open`, the large ones from its back.
  std::vector<double> share(n);
  std::vector<std::uint32_t> open(n);
  std::size_t small_count = 0, first_large = n;
  const auto put = [&](std::uint32_t i) { open[share[i] < 1.0 ? small_count++ : --first_large] = i; };
  for (std::size_t i = 0; i < n; ++i) {
    share[i] = weights[i] / table.total * static_cast<double>(n);
    put(static_cast<std::uint32_t>(i));
  }

  while (small_count > 0 && first_large < n) {
    const std::uint32_t small = open[--small_count];
    const std::uint32_t large = open[first_large++];
    table.threshold[small] = static_cast<float>(share[small]);
    table.alias[small] = large;
    // The large one gives what the rounded threshold leaves, not the exact share: errors do not add up.
    share[large] -= 1.0 - static_cast<double>(table.threshold[small]);
    put(large);
  }
  // What is left has a share of 1 up to rounding.
  const auto keep_whole = [&](std::uint32_t i) {
    table.threshold[i] = 1.0f;
    table.alias[i] = i;
  };
  for (std::size_t k = 0; k < small_count; ++k) keep_whole(open[k]);
  for (std::size_t k = first_large; k < n; ++k) keep_whole(open[k]);
  return table;
}

std::vector<double> alias_probabilities(const AliasTable& table) {
  const std::size_t n = table.threshold.size();
  std::vector<double> probability(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    const double threshold = table.threshold[i];
    probability[i] += threshold / static_cast<double>(n);
    probability[table.alias[i]] += (1.0 - threshold) / static_cast<double>(n);
  }
  return probability;
}

} // namespace wavepath
