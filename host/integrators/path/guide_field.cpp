#include "host/integrators/path/guide_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <numeric>
#include <span>

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

namespace wavepath {
namespace {

constexpr std::size_t kLeafVertices = 300;  // a cell with more is split
constexpr double kPrior = 30.0;             // samples that a quad counts as spread evenly, besides its own
constexpr std::uint32_t kCells = gpu::kGuideSide * gpu::kGuideSide;
constexpr std::array<double, 5> kProbabilities = {0.0, 0.15, 0.3, 0.45, 0.6};

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
  std::vector<std::size_t> first_leaf; // below a node
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
  tree.first_leaf.resize(tree.nodes.size());
  tree.first_leaf[node] = tree.leaves.size();
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
  void add(std::uint32_t cell, double weight) {
    sum[cell] += weight;
    squares[cell] += weight * weight;
  }
  void add(const Histogram& other) {
    for (std::uint32_t cell = 0; cell < kCells; ++cell) sum[cell] += other.sum[cell], squares[cell] += other.squares[cell];
  }
};

// The four children of a quad at a level, of sums by cell of a level of `side` cells.
std::array<std::size_t, 4> children(std::uint32_t x, std::uint32_t y, std::uint32_t side) {
  const std::size_t first = std::size_t{2 * y} * side + 2 * x;
  return {first, first + 1, first + side, first + side + 1};
}

// Densities from the root down: a quad divides its own among its cells by their sums. Few samples, or one that
// outweighs all others, tell little: by the effective number of samples n = (sum w)^2 / sum w^2 (Kish 1965), kPrior
// further ones count as spread like those of a larger part of the scene.
Map make_map(const Histogram& histogram, const Map& prior_map) {
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
  Map map(gpu::kGuideMapQuads);
  std::vector<double> densities = {0.25 / std::numbers::pi};
  std::size_t place = 0;
  for (std::uint32_t level = 0; level < gpu::kGuideLevels; ++level) {
    const std::uint32_t side = 1u << level;
    std::vector<double> finer(4 * densities.size());
    for (std::uint32_t y = 0; y < side; ++y)
      for (std::uint32_t x = 0; x < side; ++x, ++place) {
        const std::size_t quad = std::size_t{y} * side + x;
        const double sum = sums[level][quad], square = squares[level][quad];
        const double samples = square > 0.0 ? sum * sum / square : 0.0;
        const gpu::vec4 expected = prior_map[place];
        const double expected_sum = double{expected.x} + expected.y + expected.z + expected.w;
        int k = 0;
        for (const std::size_t cell : children(x, y, 2 * side)) {
          const double share = sum > 0.0 ? sums[level + 1][cell] / sum : 0.0;
          const double usual = expected_sum > 0.0 ? expected[k] / expected_sum : 0.25;
          finer[cell] = densities[quad] * 4.0 * (samples * share + prior * usual) / (samples + prior);
          map[place][k++] = static_cast<float>(finer[cell]);
        }
      }
    densities = std::move(finer);
  }
  return map;
}

Map even_map() { return Map(gpu::kGuideMapQuads, gpu::vec4(static_cast<float>(0.25 / std::numbers::pi))); }

float density(const gpu::vec4* map, const glm::vec3& direction) {
  const std::uint32_t cell = cell_of(direction), x = cell % gpu::kGuideSide, y = cell / gpu::kGuideSide;
  constexpr std::uint32_t kQuads = gpu::kGuideSide / 2;
  const gpu::vec4& quad = map[gpu::kGuideMapQuads - kQuads * kQuads + y / 2 * kQuads + x / 2];
  return quad[static_cast<int>(2 * (y & 1) + (x & 1))];
}

// Second moment of the contributions of some vertices, by the probability of guiding.
using Moments = std::array<double, kProbabilities.size()>;

void add_moments(const GuideVertex& vertex, const gpu::vec4* map, Moments& moments, Moments& logs) {
  if (!(vertex.contribution > 0.0f)) return;
  const double guided = density(map, vertex.direction);
  const double square = double{vertex.contribution} * vertex.contribution;
  for (std::size_t i = 0; i < kProbabilities.size(); ++i) {
    const double pdf = vertex.bsdf_pdf + kProbabilities[i] * vertex.share * (guided - vertex.bsdf_pdf);
    moments[i] += pdf > 0.0 ? square * vertex.pdf / pdf : 0.0;
    logs[i] -= vertex.contribution * std::log(pdf / vertex.bsdf_pdf);
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

namespace {

// The maps of a part of space: of either half of the paths, by which the other one judges it, and of both.
struct Maps {
  Map half[2], both;
};

// Of the part of space that a node stands for.
class Learner {
public:
  Learner(const std::vector<GuideVertex>& of, Tree& over)
      : vertices(of), tree(over), cells(of.size()), weights(of.size()), maps(over.leaves.size() * gpu::kGuideMapQuads),
        moments(over.leaves.size()), logs(over.leaves.size()) {
    tbb::parallel_for(std::size_t{0}, vertices.size(), [&](std::size_t i) {
      const GuideVertex& v = vertices[i];
      cells[i] = cell_of(v.direction);
      weights[i] = double{v.radiance} / v.pdf;
    });
  }

  // Leaves [first, last) are those below `node`.
  void learn(std::uint32_t node, std::size_t first, std::size_t last, const Maps& prior) {
    Histogram halves[2];
    for (std::size_t p = tree.leaves[first].first; p < tree.leaves[last - 1].last; ++p) {
      const std::uint32_t v = tree.order[p];
      if (weights[v] > 0.0) halves[vertices[v].odd].add(cells[v], weights[v]);
    }
    Maps own;
    for (const int half : {0, 1}) own.half[half] = make_map(halves[half], prior.half[half]);
    halves[0].add(halves[1]);
    own.both = make_map(halves[0], prior.both);
    if (last - first == 1) {
      std::ranges::copy(own.both, maps.begin() + static_cast<std::ptrdiff_t>(first * gpu::kGuideMapQuads));
      for (std::size_t p = tree.leaves[first].first; p < tree.leaves[first].last; ++p) {
        const GuideVertex& v = vertices[tree.order[p]];
        add_moments(v, own.half[!v.odd].data(), moments[first], logs[first]);
      }
      return;
    }
    const std::uint32_t child = tree.nodes[node].links >> 2;
    const std::size_t middle = tree.first_leaf[child + 1];
    tbb::parallel_invoke([&] { learn(child, first, middle, own); }, [&] { learn(child + 1, middle, last, own); });
  }

  const std::vector<GuideVertex>& vertices;
  Tree& tree;
  std::vector<std::uint32_t> cells;
  std::vector<double> weights;
  Map maps;
  std::vector<Moments> moments, logs;
};

} // namespace

GuideField build_field(const std::vector<GuideVertex>& vertices) {
  if (vertices.empty()) return no_field();
  Tree tree = make_tree(vertices);
  GuideField field;
  Learner learner(vertices, tree);
  learner.learn(0, 0, tree.leaves.size(), {{even_map(), even_map()}, even_map()});
  field.maps = std::move(learner.maps);
  const std::vector<Moments>& moments = learner.moments;
  const std::vector<Moments>& judges = tunable("G_KL", 1) > 0 ? learner.logs : moments;
  Moments total{};
  for (const Moments& of_leaf : judges)
    for (std::size_t i = 0; i < total.size(); ++i) total[i] += of_leaf[i];
  double before = 0.0, after = 0.0;
  for (std::size_t i = 0; i < tree.leaves.size(); ++i) {
    const Leaf& leaf = tree.leaves[i];
    Moments judged = judges[i];
    const double share = tunable("G_POOL", 0.1) / static_cast<double>(tree.leaves.size()); // of what all leaves say
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
