#include "host/integrators/path/guide_map.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>

namespace wavepath {
namespace {

constexpr std::uint32_t kGrids = 5;
static_assert(1u << kGrids == gpu::kGuideSide);
constexpr float kPrior = 30.0f; // samples that a cell counts as spread like the larger part's, besides its own
constexpr auto kEven = static_cast<float>(0.25 / std::numbers::pi);
constexpr float kDark = 1e-30f; // a density of which nothing is known but that it is small

// Index of the first cell of a grid with 2, 4, ..., kGuideSide cells a side, among the cells of all grids.
constexpr std::size_t first_of(std::uint32_t grid) { return ((std::size_t{4} << (2 * grid)) - 4) / 3; }
constexpr std::size_t kMapCells = first_of(kGrids);
constexpr std::size_t kFinest = first_of(kGrids - 1);

// Indexed by x: its bits at the even positions of a Morton number.
constexpr auto kSpread = [] {
  std::array<std::uint16_t, gpu::kGuideSide> table{};
  for (std::uint32_t x = 0; x < gpu::kGuideSide; ++x)
    for (std::uint32_t bit = 0; bit < kGrids; ++bit)
      table[x] = static_cast<std::uint16_t>(table[x] | (x >> bit & 1u) << (2 * bit));
  return table;
}();
constexpr std::uint32_t morton(std::uint32_t x, std::uint32_t y) { return kSpread[x] | std::uint32_t{kSpread[y]} << 1; }

// Sums of all grids from those of the finest, in a unit in which floats hold them.
using Pyramid = std::array<float, kMapCells>;
Pyramid pyramid(const std::vector<double>& finest, double per_unit) {
  Pyramid sums;
  for (std::size_t cell = 0; cell < kGuideCells; ++cell)
    sums[kFinest + cell] = static_cast<float>(finest[cell] * per_unit);
  for (std::uint32_t grid = kGrids - 1; grid > 0; --grid) {
    const float* finer = &sums[first_of(grid)];
    for (std::size_t cell = first_of(grid - 1); cell < first_of(grid); ++cell, finer += 4)
      sums[cell] = (finer[0] + finer[1]) + (finer[2] + finer[3]);
  }
  return sums;
}

// ---- as kernels read it ----

// The byte of a weight of at most 1, rounded, and what it stands for (path_types.h).
std::uint32_t weight_byte(float weight) {
  const auto bits = std::bit_cast<std::uint32_t>(weight);
  const std::uint32_t rounded = (bits + (1u << (gpu::kGuideWeightShift - 1))) >> gpu::kGuideWeightShift;
  constexpr std::uint32_t kLeast = gpu::kGuideWeightExponent << (23 - gpu::kGuideWeightShift);
  return std::max(rounded, kLeast) - kLeast;
}
double weight_of(std::uint32_t byte) {
  return double{std::bit_cast<float>(byte << gpu::kGuideWeightShift | gpu::kGuideWeightExponent << 23)};
}

// The block of 16 cells in a row, and how often each of them is drawn.
glm::uvec4 block_of(const float* cells, std::array<double, 16>& fractions) {
  const float most = *std::max_element(cells, cells + 16);
  glm::uvec4 block(0u);
  double sum = 0.0;
  for (std::uint32_t y = 0; y < 4; ++y)
    for (std::uint32_t x = 0; x < 4; ++x) {
      const std::uint32_t cell = morton(x, y);
      const std::uint32_t byte = weight_byte(most > 0.0f ? cells[cell] / most : 1.0f);
      block[static_cast<int>(x)] |= byte << (8 * y);
      sum += fractions[cell] = weight_of(byte);
    }
  for (double& fraction : fractions) fraction /= sum;
  return block;
}

} // namespace

void Histogram::add(std::uint32_t cell, double weight) {
  sum[cell] += weight;
  squares[cell] += weight * weight;
}

void Histogram::add(const Histogram& other) {
  for (std::uint32_t cell = 0; cell < kGuideCells; ++cell)
    sum[cell] += other.sum[cell], squares[cell] += other.squares[cell];
}

// The same arithmetic as map_position() of kernels/path/guide_map.glsl.
std::uint32_t map_cell(const glm::vec3& d) {
  const float across = d.z / std::max(std::abs(d.x) + std::abs(d.z), 1e-30f);
  const auto cell_of_unit = [](float u) {
    constexpr auto kSide = static_cast<float>(gpu::kGuideSide);
    return static_cast<std::uint32_t>(std::clamp(u * kSide, 0.0f, kSide - 1.0f));
  };
  return morton(cell_of_unit(0.25f * (d.x < 0.0f ? 3.0f - across : 1.0f + across)), cell_of_unit(0.5f * d.y + 0.5f));
}

GuideMap even_map() { return GuideMap(kMapCells, kEven); }

GuideMap train_map(const Histogram& histogram, const GuideMap& larger_part) {
  const double total = std::accumulate(histogram.sum.begin(), histogram.sum.end(), 0.0);
  const double per_unit = total > 0.0 ? 1.0 / total : 0.0;
  const Pyramid sums = pyramid(histogram.sum, per_unit), squares = pyramid(histogram.squares, per_unit * per_unit);
  const auto whole = [](const Pyramid& p) { return (p[0] + p[1]) + (p[2] + p[3]); };
  GuideMap map(kMapCells);
  // The four cells from `first` on, finer ones of a cell with these sums and densities.
  const auto divide = [&](std::size_t first, float sum, float square, float own, float usual) {
    const float samples = square > 0.0f ? sum * sum / square : 0.0f, fraction = own / (samples + kPrior);
    const float of_sums = sum > 0.0f ? 4.0f * fraction * samples / sum : 0.0f;
    const float of_prior = fraction * kPrior;
    for (std::size_t cell = first; cell < first + 4; ++cell)
      map[cell] = of_sums * sums[cell] + of_prior * (usual > kDark ? larger_part[cell] / usual : 1.0f);
  };
  divide(0, whole(sums), whole(squares), kEven, kEven);
  for (std::size_t cell = 0; cell < kFinest; ++cell)
    divide(4 * cell + 4, sums[cell], squares[cell], map[cell], larger_part[cell]);
  return map;
}

float map_density(const GuideMap& map, std::uint32_t cell) { return map[kFinest + cell]; }

float map_stretch(const glm::vec3& d) {
  const float across = std::abs(d.z) / std::max(std::abs(d.x) + std::abs(d.z), 1e-30f), along = 1.0f - across;
  return 0.5f * std::numbers::pi_v<float> * (across * across + along * along);
}

void write_map(const GuideMap& map, std::span<glm::uvec4, gpu::kGuideMapTexels> texels) {
  constexpr std::uint32_t kQuadSide = gpu::kGuideSide / 2;
  std::array<double, 16> parts{}, quads{};
  texels[0] = block_of(&map[first_of(1)], parts);
  for (std::uint32_t part_y = 0; part_y < 4; ++part_y)
    for (std::uint32_t part_x = 0; part_x < 4; ++part_x) {
      const std::uint32_t part = morton(part_x, part_y);
      texels[1 + 4 * part_y + part_x] = block_of(&map[first_of(3) + 16 * part], quads);
      for (std::uint32_t y = 0; y < 4; ++y)
        for (std::uint32_t x = 0; x < 4; ++x) {
          const std::size_t quad = 16 * part + morton(x, y);
          // The weights of blocks have a least one, so that also what is dark may be drawn.
          const float* cells = &map[kFinest + 4 * quad];
          const float learned = 0.25f * ((cells[0] + cells[1]) + (cells[2] + cells[3]));
          const auto drawn = static_cast<float>(256.0 * kEven * parts[part] * quads[quad % 16]);
          glm::uvec4& texel = texels[gpu::kGuideBlocks + (4 * part_y + y) * kQuadSide + 4 * part_x + x];
          for (std::size_t k = 0; k < 4; ++k)
            texel[static_cast<int>(k)] =
                std::bit_cast<std::uint32_t>(learned > kDark ? drawn * (cells[k] / learned) : drawn);
        }
    }
}

} // namespace wavepath
