#include "host/integrators/path/guide_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <numeric>
#include <span>

#include <tbb/parallel_for.h>

namespace wavepath {
namespace {

constexpr std::size_t kLeafVertices = 1000; // a cell with more is split
constexpr double kPrior = 2.0;              // samples that a quad counts as spread evenly, besides its own
constexpr std::uint32_t kCells = gpu::kGuideSide * gpu::kGuideSide;
constexpr std::array<double, 5> kProbabilities = {0.0, 0.25, 0.5, 0.75, 0.9};

double tunable(const char* name, double value) {
  const char* text = std::getenv(name);
  return text ? std::atof(text) : value;
}

using Map = std::vector<gpu::vec4>;

// A leaf of the tree: the vertices [first, last) of the order, and the node that stands for it.
struct Leaf {
  std::size_t first, last;
  std::uint32_t node;
};

struct Tree {
  std::vector<std::uint32_t> order; // of vertices
  std::vector<gpu::GuideNode> nodes;
  std::vector<Leaf> leaves;
};

int longest_axis(const std::vector<GuideVertex>& vertices, std::span<const std::uint32_t> part) {
  glm::vec3 lo = vertices[part.front()].position, hi = lo;
  for (const std::uint32_t i : part) lo = glm::min(lo, vertices[i].position), hi = glm::max(hi, vertices[i].position);
  const glm::vec3 size = hi - lo;
  const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
  return size[axis] > 0.0f ? axis : -1;
}

void split(const std::vector<GuideVertex>& vertices, std::size_t leaf_size, Tree& tree, std::uint32_t node,
           std::size_t first, std::size_t last) {
  const std::span<std::uint32_t> part(tree.order.data() + first, last - first);
  const int axis = part.size() < 2 * leaf_size ? -1 : longest_axis(vertices, part);
  if (axis >= 0) {
    const auto key = [&](std::uint32_t i) { return vertices[i].position[axis]; };
    const auto middle = part.begin() + static_cast<std::ptrdiff_t>(part.size() / 2);
    std::ranges::nth_element(part, middle, {}, key);
    const float plane = key(*middle);
    const auto upper = std::partition(part.begin(), part.end(), [&](std::uint32_t i) { return key(i) < plane; });
    const auto below = static_cast<std::size_t>(upper - part.begin());
    if (below > 0 && below < part.size()) {
      const auto child = static_cast<std::uint32_t>(tree.nodes.size());
      tree.nodes[node] = {plane, child << 2 | static_cast<std::uint32_t>(axis)};
      tree.nodes.resize(tree.nodes.size() + 2);
      split(vertices, leaf_size, tree, child, first, first + below);
      split(vertices, leaf_size, tree, child + 1, first + below, last);
      return;
    }
  }
  tree.nodes[node] = {0.0f, static_cast<std::uint32_t>(tree.leaves.size()) << 2 | gpu::kGuideLeafAxis};
  tree.leaves.push_back({first, last, node});
}

Tree make_tree(const std::vector<GuideVertex>& vertices) {
  Tree tree;
  tree.order.resize(vertices.size());
  std::iota(tree.order.begin(), tree.order.end(), 0u);
  tree.nodes.resize(1);
  // Halves by the median hold half each, so that leaves hold at least leaf_size vertices. Ties may unbalance them.
  const auto least = static_cast<std::size_t>(tunable("G_LEAF", kLeafVertices));
  split(vertices, std::max(least, 2 * vertices.size() / kMostGuideLeaves), tree, 0, 0, vertices.size());
  return tree;
}

std::uint32_t cell_of(const glm::vec3& d) {
  constexpr auto kSide = static_cast<double>(gpu::kGuideSide);
  const double u = std::atan2(d.z, d.x) / (2.0 * std::numbers::pi) + 0.5, v = 0.5 * d.y + 0.5;
  const auto place = [](double x) {
    return static_cast<std::uint32_t>(std::clamp(x * kSide, 0.0, kSide - 1.0));
  };
  return place(v) * gpu::kGuideSide + place(u);
}

// What the directions of some vertices weigh, by cell.
struct Histogram {
  std::vector<double> sum = std::vector<double>(kCells), squares = std::vector<double>(kCells);
  void add(const GuideVertex& vertex) {
    const double weight = double{vertex.radiance} / vertex.pdf;
    const std::uint32_t cell = cell_of(vertex.direction);
    sum[cell] += weight;
    squares[cell] += weight * weight;
  }
};

// The four children of a quad at a level, of sums by cell of a level of `side` cells.
std::array<std::size_t, 4> children(std::uint32_t x, std::uint32_t y, std::uint32_t side) {
  const std::size_t first = std::size_t{2 * y} * side + 2 * x;
  return {first, first + 1, first + side, first + side + 1};
}

// Densities from the root down: a quad divides its own among its cells by their sums. Few samples, or one that
// outweighs all others, tell little: by the effective number of samples n = (sum w)^2 / sum w^2 (Kish 1965), kPrior
// further ones count as spread evenly.
void make_map(const Histogram& histogram, gpu::vec4* map) {
  static const double prior = tunable("G_PRIOR", kPrior);
  std::array<std::vector<double>, gpu::kGuideLevels + 1> sums, squares; // of level l: 2^l cells a side
  sums[gpu::kGuideLevels] = histogram.sum, squares[gpu::kGuideLevels] = histogram.squares;
  for (std::uint32_t level = gpu::kGuideLevels; level-- > 0;) {
    const std::uint32_t side = 1u << level;
    for (auto* pyramid : {&sums, &squares}) {
      std::vector<double>& coarse = (*pyramid)[level];
      coarse.resize(std::size_t{side} * side);
      for (std::uint32_t y = 0; y < side; ++y)
        for (std::uint32_t x = 0; x < side; ++x)
          for (const std::size_t cell : children(x, y, 2 * side)) coarse[y * side + x] += (*pyramid)[level + 1][cell];
    }
  }
  std::vector<double> densities = {0.25 / std::numbers::pi};
  for (std::uint32_t level = 0; level < gpu::kGuideLevels; ++level) {
    const std::uint32_t side = 1u << level;
    std::vector<double> finer(4 * densities.size());
    for (std::uint32_t y = 0; y < side; ++y)
      for (std::uint32_t x = 0; x < side; ++x) {
        const std::size_t quad = std::size_t{y} * side + x;
        const double sum = sums[level][quad], square = squares[level][quad];
        const double samples = square > 0.0 ? sum * sum / square : 0.0;
        gpu::vec4 entry;
        int k = 0;
        for (const std::size_t cell : children(x, y, 2 * side)) {
          const double share = sum > 0.0 ? sums[level + 1][cell] / sum : 0.25;
          finer[cell] = densities[quad] * 4.0 * (samples * share + 0.25 * prior) / (samples + prior);
          entry[k++] = static_cast<float>(finer[cell]);
        }
        *map++ = entry;
      }
    densities = std::move(finer);
  }
}

float density(const gpu::vec4* map, const glm::vec3& direction) {
  const std::uint32_t cell = cell_of(direction), x = cell % gpu::kGuideSide, y = cell / gpu::kGuideSide;
  constexpr std::uint32_t kQuads = gpu::kGuideSide / 2;
  const gpu::vec4& quad = map[gpu::kGuideMapQuads - kQuads * kQuads + y / 2 * kQuads + x / 2];
  return quad[static_cast<int>(2 * (y & 1) + (x & 1))];
}

// Second moment of the contributions of some vertices, by the probability of guiding.
using Moments = std::array<double, kProbabilities.size()>;

void add_moments(const GuideVertex& vertex, const gpu::vec4* map, Moments& moments) {
  if (!(vertex.contribution > 0.0f)) return;
  const double guided = density(map, vertex.direction);
  const double square = double{vertex.contribution} * vertex.contribution;
  for (std::size_t i = 0; i < kProbabilities.size(); ++i) {
    const double pdf = vertex.bsdf_pdf + kProbabilities[i] * (guided - vertex.bsdf_pdf);
    moments[i] += pdf > 0.0 ? square * vertex.pdf / pdf : 0.0;
  }
}

std::size_t least(const Moments& moments) {
  return static_cast<std::size_t>(std::ranges::min_element(moments) - moments.begin());
}

} // namespace

GuideField no_field() {
  GuideField field;
  field.nodes = {{0.0f, gpu::kGuideLeafAxis}};
  field.maps.assign(gpu::kGuideMapQuads, gpu::vec4(static_cast<float>(0.25 / std::numbers::pi)));
  return field;
}

GuideField build_field(const std::vector<GuideVertex>& vertices) {
  if (vertices.empty()) return no_field();
  Tree tree = make_tree(vertices);
  GuideField field;
  field.maps.resize(tree.leaves.size() * gpu::kGuideMapQuads);
  std::vector<Moments> moments(tree.leaves.size());
  tbb::parallel_for(std::size_t{0}, tree.leaves.size(), [&](std::size_t i) {
    const Leaf& leaf = tree.leaves[i];
    const std::span<const std::uint32_t> part(tree.order.data() + leaf.first, leaf.last - leaf.first);
    gpu::vec4* map = field.maps.data() + i * gpu::kGuideMapQuads;
    moments[i] = {};
    for (const bool half : {false, true}) { // each half of the paths judges what the other one has learned
      Histogram histogram;
      for (const std::uint32_t v : part)
        if (vertices[v].odd == half) histogram.add(vertices[v]);
      make_map(histogram, map);
      for (const std::uint32_t v : part)
        if (vertices[v].odd != half) add_moments(vertices[v], map, moments[i]);
    }
    Histogram histogram;
    for (const std::uint32_t v : part) histogram.add(vertices[v]);
    make_map(histogram, map);
  });
  Moments total{};
  for (const Moments& of_leaf : moments)
    for (std::size_t i = 0; i < total.size(); ++i) total[i] += of_leaf[i];
  double before = 0.0, after = 0.0;
  for (std::size_t i = 0; i < tree.leaves.size(); ++i) {
    const Leaf& leaf = tree.leaves[i];
    Moments judged = moments[i];
    const double share = tunable("G_POOL", 0.1) * moments[i][0] / std::max(total[0], 1e-300); // of what all leaves say
    for (std::size_t k = 0; k < judged.size(); ++k) judged[k] += share * total[k];
    const std::size_t best = least(judged);
    static const double fixed = tunable("G_ALPHA", -1.0);
    const double probability = fixed >= 0.0 ? fixed : kProbabilities[best];
    tree.nodes[leaf.node].split = static_cast<float>(probability);
    field.probability += probability * static_cast<double>(leaf.last - leaf.first) / static_cast<double>(vertices.size());
    before += moments[i][0], after += moments[i][best];
  }
  field.gain = before > 0.0 ? after / before : 1.0;
  field.nodes = std::move(tree.nodes);
  return field;
}

} // namespace wavepath
