#include "host/integrators/path/cell_histograms.h"

#include <cmath>
#include <utility>

#include "kernels/base/light_tree_types.h"

namespace wavepath {
namespace {

std::uint64_t sum_at(const std::uint32_t* words) { return words[0] | std::uint64_t{words[1]} << 32; }

std::uint32_t widest_of(std::uint32_t cells_around) { return (cells_around - 1) % gpu::kLightCells; }

} // namespace

std::vector<std::uint32_t> in_every_cell(std::span<const std::uint32_t> cell) {
  std::vector<std::uint32_t> words;
  words.reserve(gpu::kLightCells * cell.size());
  for (std::uint32_t r = 0; r < gpu::kLightCells; ++r) words.insert(words.end(), cell.begin(), cell.end());
  return words;
}

CellHistograms::CellHistograms(Probabilities prior, std::size_t bins, double prior_picks,
                               std::span<const std::uint32_t> sums)
    : prior_(std::move(prior)), bins_(bins), prior_picks_(prior_picks), sums_(sums) {
  for (std::uint32_t cell = 0; cell < gpu::kLightCells; ++cell) {
    const std::uint32_t wider = cells_around(cell);
    if (wider == 0) continue;
    cells_.push_back(cell);
    add(cell, wider_[wider]);
    add(cell, widest_[widest_of(wider)]);
  }
}

void CellHistograms::add(std::uint32_t cell, Sums& to) const {
  const std::uint32_t* words = words_of(cell);
  to.brought.resize(bins_), to.arrived.resize(bins_);
  for (std::size_t c = 0; c < bins_; ++c) {
    to.brought[c] += sum_at(words + 4 * c);
    to.arrived[c] += sum_at(words + 4 * c + 2);
  }
  to.picks += words[4 * bins_];
}

CellHistograms::Probabilities CellHistograms::trained(std::uint32_t cell) {
  const std::uint32_t wider = cells_around(cell);
  const Probabilities& widest = probabilities_of(widest_.at(widest_of(wider)), prior_);
  Sums own;
  add(cell, own);
  return mix(own, probabilities_of(wider_.at(wider), widest));
}

const CellHistograms::Probabilities& CellHistograms::probabilities_of(Sums& wider, const Probabilities& around) const {
  if (wider.trained.empty()) wider.trained = mix(wider, around);
  return wider.trained;
}

// The variance is least where a bin's probability is proportional to the root of the mean square of its contribution.
// Blocked light contributes nothing: a bin that contributes m if visible, and is visible with probability v, has the
// root mean square sqrt(v) m, which is the geometric mean of both sums.
CellHistograms::Probabilities CellHistograms::mix(const Sums& sums, const Probabilities& around) const {
  Probabilities probabilities(prior_.size(), 0.0);
  double total = 0.0;
  for (std::size_t c = 0; c < bins_; ++c) {
    probabilities[c] = std::sqrt(static_cast<double>(sums.brought[c]) * static_cast<double>(sums.arrived[c]));
    total += probabilities[c];
  }
  if (!(total > 0.0)) return around;
  const double kept = prior_picks_ / (prior_picks_ + static_cast<double>(sums.picks));
  for (std::size_t c = 0; c < probabilities.size(); ++c)
    probabilities[c] = kept * around[c] + (1.0 - kept) * probabilities[c] / total;
  return probabilities;
}

} // namespace wavepath
