// What a pilot's sums by cells of space teach: shares of columns, be they lights or parts of a sky.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace wavepath {

// kLightCells copies of the words of a row.
std::vector<std::uint32_t> in_every_cell(std::span<const std::uint32_t> cell);

// `sums`, as kernels/path/connect.comp makes them: a row of columns + 1 times four words for each of kLightCells cells.
// 64 bits of what a column would bring, 64 bits of what arrives; behind the columns picks, and the wider cells around
// it: 1 + kLightCells * (row of that four times as wide) + row of that sixteen times as wide. Of cells that share a row
// by chance, all sums teach the wider cells of one. They outlive the lessons.
class CellHistograms {
public:
  using Probabilities = std::vector<double>;

  // `prior`: shares without a lesson, which sum to 1; those beyond `columns` cannot be learned. `prior_picks`: as how
  // many picks of a cell's own what is known around it counts.
  CellHistograms(Probabilities prior, std::size_t bins, double prior_picks, std::span<const std::uint32_t> sums);

  // Rows that the pilot came to, rising.
  std::span<const std::uint32_t> cells() const { return cells_; }
  // What such a row has learned, its few picks filled up by those of the cells around it.
  Probabilities trained(std::uint32_t cell);

private:
  // Of a cell, or of all cells within a wider one.
  struct Sums {
    std::vector<std::uint64_t> brought, arrived; // by column
    std::uint64_t picks = 0;
    Probabilities trained; // empty: not yet asked for
  };
  using WiderCells = std::unordered_map<std::uint32_t, Sums>;

  const std::uint32_t* words_of(std::uint32_t cell) const { return &sums_[4 * (bins_ + 1) * cell]; }
  std::uint32_t cells_around(std::uint32_t cell) const { return words_of(cell)[4 * bins_ + 1]; } // 0: no pick
  void add(std::uint32_t cell, Sums& to) const;
  Probabilities mix(const Sums& sums, const Probabilities& around) const;
  const Probabilities& probabilities_of(Sums& wider, const Probabilities& around) const;

  Probabilities prior_;
  std::size_t bins_;
  double prior_picks_;
  std::span<const std::uint32_t> sums_;
  std::vector<std::uint32_t> cells_;
  WiderCells wider_, widest_; // by cells_around(), and by its widest cell
};

} // namespace wavepath
