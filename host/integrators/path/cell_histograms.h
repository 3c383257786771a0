// Probabilities of bins, by cell of space, trained by the sums of a training pass. Bins are clusters of lights, or
// parts of a sky.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace wavepath {

// The words of one cell, for each of kLightCells cells.
std::vector<std::uint32_t> in_every_cell(std::span<const std::uint32_t> cell);

// Layout of `sums`, which kernels/path/connect.comp writes: kLightCells cells of (bins + 1) * 4 words.
//
//     cell     bin 0                    bin 1      ...   behind the bins
//     words    uint64 unblocked light   ...              picks, wider cells, unused, unused
//              uint64 light that arrives
//
// Wider cells: 1 + kLightCells * (index of the cell 4 times as wide) + (index of that 16 times as wide); 0 if the cell
// was never visited. Cells whose hashes are equal share their sums, which count for the wider cells of one of them. The
// sums outlive the histograms.
class CellHistograms {
public:
  using Probabilities = std::vector<double>;

  // `prior`: probabilities without training, which sum to 1; those beyond `bins` are not trained. `prior_picks`: weight
  // of the cells around a cell, in picks of its own.
  CellHistograms(Probabilities prior, std::size_t bins, double prior_picks, std::span<const std::uint32_t> sums);

  // Cells that the training pass visited, ascending.
  std::span<const std::uint32_t> cells() const { return cells_; }
  // Trained probabilities of such a cell. The fewer picks it has, the more the cells around it count.
  Probabilities trained(std::uint32_t cell);

private:
  // Of a cell, or of all cells within a wider one.
  struct Sums {
    std::vector<std::uint64_t> brought, arrived; // by bin
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
