#include "host/integrators/path/cell_lessons.h"

#include <cmath>
#include <utility>

#include "kernels/light_tree_types.h"

namespace wavepath {
namespace {

double sum_at(const std::uint32_t* words) { return words[0] + 0x1p32 * words[1]; }

} // namespace

CellLessons::CellLessons(Shares prior, std::size_t columns, double prior_picks, std::span<const std::uint32_t> sums)
    : prior_(std::move(prior)),
      columns_(columns),
      prior_picks_(prior_picks),
      sums_(sums),
      places_(gpu::kLightRows, gpu::kNone) {}

const CellLessons::Shares& CellLessons::learned(std::uint32_t row) {
  if (places_[row] != gpu::kNone) return learned_[places_[row]];
  places_[row] = static_cast<std::uint32_t>(learned_.size());
  Shares& own = learned_.emplace_back(prior_); // ends the search, should rows that share a place lead in a circle
  const std::uint32_t parent = parent_of(row);
  own = mix(row, parent > 0 ? learned(parent - 1) : prior_);
  return own;
}

// The variance is least where a column's share is in proportion to the root of the mean square of what it brings. What
// is blocked brings nothing: of a column that brings m if visible, and is visible with probability v, that is sqrt(v)
// m, the geometric mean of both sums.
CellLessons::Shares CellLessons::mix(std::uint32_t row, const Shares& around) const {
  const std::uint32_t* sums = row_of(row);
  Shares shares(prior_.size(), 0.0);
  double total = 0.0;
  for (std::size_t c = 0; c < columns_; ++c) {
    shares[c] = std::sqrt(sum_at(sums + 4 * c) * sum_at(sums + 4 * c + 2));
    total += shares[c];
  }
  if (!(total > 0.0)) return around;
  const double kept = prior_picks_ / (prior_picks_ + picks(row));
  for (std::size_t c = 0; c < shares.size(); ++c) shares[c] = kept * around[c] + (1.0 - kept) * shares[c] / total;
  return shares;
}

} // namespace wavepath
