// Probabilities of bins for each cell of space, trained from the sums of a training pass. A bin is a cluster of lights
// or a part of the sky.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace wavepath {

// The words of one cell, repeated for each of kLightCells cells.
std::vector<std::uint32_t> in_every_cell(std::span<const std::uint32_t> cell);

// Layout of `sums`, which kernels/path/connect.comp writes: kLightCells cells of (bins + 1) * 4 words.
//
//     cell     bin 0                    bin 1      ...   behind the bins
//     words    uint64 unblocked light   ...              picks, wider cells, unused, unused
//              uint64 light that arrives
//
// Wider cells: 1 + kLightCells * (index of the cell 4 times as wide) + (index of the cell 16 times as wide); 0 if the
// cell was never visited. Cells with equal hashes share their sums, which then count for the wider cells of one of
// them. The sums must outlive this object.
class CellHistograms {
public:
  using Probabilities = std::vector<double>;

  // `prior`: probabilities without training, which sum to 1; those beyond `bins` are not trained. `prior_picks`: weight
  // of the next wider cell, as a number of picks.
  CellHistograms(Probabilities prior, std::size_t bins, double prior_picks, std::span<const std::uint32_t> sums);

  // Indices of the cells that the training pass visited, ascending.
  std::span<const std::uint32_t> cells() const { return cells_; }
  // Trained probabilities of a visited cell. The fewer picks it has, the more the wider cells count.
  Probabilities trained(std::uint32_t cell);

private:
  // Sums of a cell, or of all cells within a wider one.
  struct Sums {
    std::vector<std::uint64_t> brought, arrived; // indexed by bin
    std::uint64_t picks = 0;
    Probabilities trained; // empty until they are asked for
  };
  using WiderCells = std::unordered_map<std::uint32_t, Sums>;

  const std::uint32_t* words_of(std::uint32_t cell) const { return &sums_[4 * (bins_ + 1) * cell]; }
  std::uint32_t cells_around(std::uint32_t cell) const { return words_of(cell)[4 * bins_ + 1]; } // 0: never visited
  void add(std::uint32_t cell, Sums& to) const;
  Probabilities mix(const Sums& sums, const Probabilities& around) const;
  const Probabilities& probabilities_of(Sums& wider, const Probabilities& around) const;

  Probabilities prior_;
  std::size_t bins_;
  double prior_picks_;
  std::span<const std::uint32_t> sums_;
  std::vector<std::uint32_t> cells_;
  WiderCells wider_, widest_; // keys: cells_around(); its widest cell
};

} // namespace wavepath
