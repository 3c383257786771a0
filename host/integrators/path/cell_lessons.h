// What a pilot's sums by cells of space teach: shares of columns, be they lights or parts of a sky.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

namespace wavepath {

// `sums`, as kernels/path/connect.comp makes them: a row of columns + 1 times four words for each of kLightRows cells.
// 64 bits of what a column would bring, 64 bits of what arrives; behind the columns picks, and the row of the cell
// around it plus one. They outlive the lessons.
class CellLessons {
public:
  using Shares = std::vector<double>;

  // `prior`: shares without a lesson, which sum to 1; those beyond `columns` cannot be learned. `prior_picks`: as how
  // many picks of a cell's own what is known around it counts.
  CellLessons(Shares prior, std::size_t columns, double prior_picks, std::span<const std::uint32_t> sums);

  // What the row has learned, its few picks filled up by those of the cell around it.
  const Shares& learned(std::uint32_t row);
  std::uint32_t picks(std::uint32_t row) const { return behind(row)[0]; }
  // Whether the pilot came to its cell, or to one within.
  bool is_touched(std::uint32_t row) const { return picks(row) > 0 || parent_of(row) > 0; }

private:
  const std::uint32_t* row_of(std::uint32_t row) const { return &sums_[4 * (columns_ + 1) * row]; }
  const std::uint32_t* behind(std::uint32_t row) const { return row_of(row) + 4 * columns_; }
  std::uint32_t parent_of(std::uint32_t row) const { return behind(row)[1]; } // plus one; 0: none
  Shares mix(std::uint32_t row, const Shares& around) const;

  Shares prior_;
  std::size_t columns_;
  double prior_picks_;
  std::span<const std::uint32_t> sums_;
  std::vector<std::uint32_t> places_; // by row, in learned_
  std::deque<Shares> learned_;        // of the rows asked for, which are few: their places last
};

} // namespace wavepath
