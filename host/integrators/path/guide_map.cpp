#include "host/integrators/path/guide_map.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace wavepath {
namespace {

constexpr std::uint32_t kGrids = 5;
static_assert(1u << kGrids == gpu::kGuideSide);
constexpr double kPrior = 30.0; // samples that a cell counts as spread like the larger part's, besides its own
constexpr double kEven = 0.25 / std::numbers::pi;

constexpr std::uint32_t side_of(std::uint32_t grid) { return 2u << grid; }
constexpr std::size_t first_of(std::uint32_t grid) { return 4 * ((std::size_t{1} << (2 * grid)) - 1) / 3; }
constexpr std::size_t kMapCells = first_of(kGrids);

// The four cells below cell (x, y) of the next coarser grid, by two rows.
std::array<std::size_t, 4> finer_cells(std::uint32_t grid, std::uint32_t x, std::uint32_t y) {
  const std::size_t side = side_of(grid), first = first_of(grid) + 2 * y * side + 2 * x;
  return {first, first + 1, first + side, first + side + 1};
}

// Sums of all grids from those of the finest; the whole sphere's last.
std::vector<double> pyramid(const std::vector<double>& finest) {
  std::vector<double> sums(kMapCells + 1);
  std::ranges::copy(finest, sums.begin() + first_of(kGrids - 1));
  for (std::uint32_t grid = kGrids; grid-- > 0;) {
    const std::uint32_t coarser_side = side_of(grid) / 2;
    for (std::uint32_t y = 0; y < coarser_side; ++y)
      for (std::uint32_t x = 0; x < coarser_side; ++x) {
        double& sum = sums[grid > 0 ? first_of(grid - 1) + y * coarser_side + x : kMapCells];
        for (const std::size_t cell : finer_cells(grid, x, y)) sum += sums[cell];
      }
  }
  return sums;
}

// ---- as kernels read it ----

// The byte of a weight of at most 1, rounded, and what it stands for (path_types.h).
std::uint32_t weight_byte(double weight) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(weight));
  const std::uint32_t rounded = (bits + (1u << (gpu::kGuideWeightShift - 1))) >> gpu::kGuideWeightShift;
  constexpr std::uint32_t kLeast = gpu::kGuideWeightExponent << (23 - gpu::kGuideWeightShift);
  return std::max(rounded, kLeast) - kLeast;
}
double weight_of(std::uint32_t byte) {
  return double{std::bit_cast<float>(byte << gpu::kGuideWeightShift | gpu::kGuideWeightExponent << 23)};
}

// The block of the 4x4 cells of a grid from (4 x, 4 y) on, and how often each of them is drawn (by rows).
glm::uvec4 block_of(const GuideMap& map, std::uint32_t grid, std::uint32_t x, std::uint32_t y,
                    std::array<double, 16>& shares) {
  double most = 0.0;
  for (std::uint32_t cell = 0; cell < 16; ++cell) {
    shares[cell] = map[first_of(grid) + std::size_t{4 * y + cell / 4} * side_of(grid) + 4 * x + cell % 4];
    most = std::max(most, shares[cell]);
  }
  glm::uvec4 block(0u);
  double sum = 0.0;
  for (std::uint32_t cell = 0; cell < 16; ++cell) {
    const std::uint32_t byte = weight_byte(most > 0.0 ? shares[cell] / most : 1.0);
    block[static_cast<int>(cell % 4)] |= byte << (8 * (cell / 4));
    sum += shares[cell] = weight_of(byte);
  }
  for (double& share : shares) share /= sum;
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

// As map_place() of kernels/path/guide_map.glsl.
std::uint32_t map_cell(const glm::vec3& d) {
  const float across = d.z / std::max(std::abs(d.x) + std::abs(d.z), 1e-30f);
  const auto place = [](float u) {
    constexpr auto kSide = static_cast<float>(gpu::kGuideSide);
    return static_cast<std::uint32_t>(std::clamp(u * kSide, 0.0f, kSide - 1.0f));
  };
  return place(0.5f * d.y + 0.5f) * gpu::kGuideSide + place(0.25f * (d.x < 0.0f ? 3.0f - across : 1.0f + across));
}

GuideMap even_map() { return GuideMap(kMapCells, static_cast<float>(kEven)); }

GuideMap learn_map(const Histogram& histogram, const GuideMap& larger_part) {
  const std::vector<double> sums = pyramid(histogram.sum), squares = pyramid(histogram.squares);
  GuideMap map(kMapCells);
  for (std::uint32_t grid = 0; grid < kGrids; ++grid) {
    const std::uint32_t coarser_side = side_of(grid) / 2;
    for (std::uint32_t y = 0; y < coarser_side; ++y)
      for (std::uint32_t x = 0; x < coarser_side; ++x) {
        const std::size_t above = grid > 0 ? first_of(grid - 1) + y * coarser_side + x : kMapCells;
        const double sum = sums[above], square = squares[above], own = grid > 0 ? double{map[above]} : kEven;
        const double samples = square > 0.0 ? sum * sum / square : 0.0;
        const auto cells = finer_cells(grid, x, y);
        double usual_sum = 0.0;
        for (const std::size_t cell : cells) usual_sum += larger_part[cell];
        for (const std::size_t cell : cells) {
          const double share = sum > 0.0 ? sums[cell] / sum : 0.0;
          const double usual = usual_sum > 0.0 ? larger_part[cell] / usual_sum : 0.25;
          map[cell] = static_cast<float>(own * 4.0 * (samples * share + kPrior * usual) / (samples + kPrior));
        }
      }
  }
  return map;
}

float map_density(const GuideMap& map, const glm::vec3& direction) {
  const float across = std::abs(direction.z) / std::max(std::abs(direction.x) + std::abs(direction.z), 1e-30f);
  const float along = 1.0f - across; // below: map_stretch() of the kernels
  return map[first_of(kGrids - 1) + map_cell(direction)] * 0.5f * std::numbers::pi_v<float> *
         (across * across + along * along);
}

void write_map(const GuideMap& map, std::span<glm::uvec4, gpu::kGuideMapTexels> texels) {
  constexpr std::uint32_t kQuadSide = gpu::kGuideSide / 2;
  std::array<double, 16> parts{}, quads{};
  texels[0] = block_of(map, 1, 0, 0, parts);
  for (std::uint32_t part = 0; part < 16; ++part) {
    texels[1 + part] = block_of(map, 3, part % 4, part / 4, quads);
    for (std::uint32_t quad = 0; quad < 16; ++quad) {
      const std::uint32_t x = part % 4 * 4 + quad % 4, y = part / 4 * 4 + quad / 4;
      const double learned = map[first_of(3) + y * kQuadSide + x], drawn = kEven * 256.0 * parts[part] * quads[quad];
      glm::uvec4& texel = texels[gpu::kGuideBlocks + y * kQuadSide + x];
      const auto cells = finer_cells(4, x, y);
      for (std::size_t k = 0; k < 4; ++k)
        texel[static_cast<int>(k)] =
            std::bit_cast<std::uint32_t>(static_cast<float>(learned > 0.0 ? map[cells[k]] * (drawn / learned) : drawn));
    }
  }
}

} // namespace wavepath
