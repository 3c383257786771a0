#include "host/integrators/path/guide_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

namespace wavepath {
namespace {

constexpr std::size_t kLeafVertices = 300; // a cell with more is split
constexpr double kPrior = 30.0;            // samples that a quad counts as spread evenly, besides its own
constexpr double kCommon = 0.1;            // share of an average leaf in what all leaves say of the probability
constexpr std::uint32_t kCells = gpu::kGuideSide * gpu::kGuideSide;
constexpr std::array<double, 5> kProbabilities = {0.0, 0.15, 0.3, 0.45, 0.6};

using Map = std::vector<gpu::vec4>;

// A part of space: the vertices [first, last) of the order. Halved at `plane` along `axis` into the nodes `child` and
// child + 1; a leaf has no axis.
struct Node {
  std::size_t first = 0, last = 0;
  int axis = -1;
  float plane = 0.0f;
  std::uint32_t child = 0;
  std::uint32_t first_leaf = 0, last_leaf = 0; // below it
};

// A vertex while space is divided, small enough that sorting stays in the caches.
struct Point {
  glm::vec3 position;
  std::uint32_t vertex;
};

struct Tree {
  std::vector<Point> order;
  std::vector<Node> nodes;           // the root first
  std::vector<std::uint32_t> leaves; // their nodes
};

// -1 if all points are in one place.
int longest_axis(std::span<const Point> part) {
  glm::vec3 lo = part.front().position, hi = lo;
  for (const Point& p : part) lo = glm::min(lo, p.position), hi = glm::max(hi, p.position);
  const glm::vec3 size = hi - lo;
  const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
  return size[axis] > 0.0f ? axis : -1;
}

// Halves a part at the median, ties above it; false if that leaves one half empty.
bool halve(std::span<Point> part, Node& node, std::size_t& below) {
  node.axis = longest_axis(part);
  if (node.axis < 0) return false;
  const auto key = [&](const Point& p) { return p.position[node.axis]; };
  const auto middle = part.begin() + static_cast<std::ptrdiff_t>(part.size() / 2);
  std::ranges::nth_element(part, middle, {}, key);
  node.plane = key(*middle);
  const auto upper = std::partition(part.begin(), part.end(), [&](const Point& p) { return key(p) < node.plane; });
  below = static_cast<std::size_t>(upper - part.begin());
  return below > 0;
}

void split(std::size_t leaf_size, Tree& tree, std::uint32_t index) {
  Node node = tree.nodes[index];
  node.first_leaf = static_cast<std::uint32_t>(tree.leaves.size());
  const std::span<Point> part(tree.order.data() + node.first, node.last - node.first);
  std::size_t below = 0;
  if (part.size() >= 2 * leaf_size && halve(part, node, below)) {
    node.child = static_cast<std::uint32_t>(tree.nodes.size());
    tree.nodes.push_back({.first = node.first, .last = node.first + below});
    tree.nodes.push_back({.first = node.first + below, .last = node.last});
    split(leaf_size, tree, node.child);
    split(leaf_size, tree, node.child + 1);
  } else {
    node.axis = -1;
    tree.leaves.push_back(index);
  }
  node.last_leaf = static_cast<std::uint32_t>(tree.leaves.size());
  tree.nodes[index] = node;
}

Tree make_tree(const std::vector<GuideVertex>& vertices) {
  Tree tree;
  tree.order.reserve(vertices.size());
  for (std::uint32_t i = 0; i < vertices.size(); ++i) tree.order.push_back({vertices[i].position, i});
  tree.nodes.push_back({.first = 0, .last = vertices.size()});
  // A leaf holds at least half of what a part may hold unsplit, but for ties at the median.
  split(std::max(kLeafVertices, 2 * vertices.size() / kMostGuideLeaves), tree, 0);
  return tree;
}

// As kernels read it, two levels a node. A leaf below a first half stands there twice.
void flatten(const Tree& tree, const std::vector<float>& probabilities, std::uint32_t index, std::size_t place,
             std::vector<gpu::GuideNode>& flat) {
  const Node& node = tree.nodes[index];
  if (node.axis < 0) {
    flat[place] = {glm::vec3(probabilities[node.first_leaf]),
                   node.first_leaf << gpu::kGuideLinkShift | gpu::kGuideLeafAxis};
    return;
  }
  const auto first = static_cast<std::uint32_t>(flat.size());
  flat.resize(flat.size() + 4);
  gpu::GuideNode entry{glm::vec3(node.plane), first << gpu::kGuideLinkShift | static_cast<std::uint32_t>(node.axis)};
  for (std::uint32_t half = 0; half < 2; ++half) {
    const Node& child = tree.nodes[node.child + half];
    const bool is_leaf = child.axis < 0;
    entry.splits[static_cast<int>(half) + 1] = child.plane;
    entry.links |= static_cast<std::uint32_t>(std::max(child.axis, 0)) << (2 + 2 * half);
    for (std::uint32_t quarter = 0; quarter < 2; ++quarter)
      flatten(tree, probabilities, is_leaf ? node.child + half : child.child + quarter, first + 2 * half + quarter,
              flat);
  }
  flat[place] = entry;
}

std::uint32_t cell_of(const glm::vec3& d) {
  constexpr auto kSide = static_cast<double>(gpu::kGuideSide);
  const double u = std::atan2(d.z, d.x) / (2.0 * std::numbers::pi) + 0.5, v = 0.5 * d.y + 0.5;
  const auto place = [](double x) { return static_cast<std::uint32_t>(std::clamp(x * kSide, 0.0, kSide - 1.0)); };
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
    for (std::uint32_t cell = 0; cell < kCells; ++cell)
      sum[cell] += other.sum[cell], squares[cell] += other.squares[cell];
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
          finer[cell] = densities[quad] * 4.0 * (samples * share + kPrior * usual) / (samples + kPrior);
          map[place][k++] = static_cast<float>(finer[cell]);
        }
      }
    densities = std::move(finer);
  }
  return map;
}

Map even_map() { return Map(gpu::kGuideMapQuads, gpu::vec4(static_cast<float>(0.25 / std::numbers::pi))); }

float density(const Map& map, const glm::vec3& direction) {
  const std::uint32_t cell = cell_of(direction), x = cell % gpu::kGuideSide, y = cell / gpu::kGuideSide;
  constexpr std::uint32_t kQuads = gpu::kGuideSide / 2;
  const gpu::vec4& quad = map[gpu::kGuideMapQuads - kQuads * kQuads + y / 2 * kQuads + x / 2];
  return quad[static_cast<int>(2 * (y & 1) + (x & 1))];
}

// Of the contributions of some vertices, by the probability of guiding: their second moment, and their cross-entropy
// with the density of both techniques.
struct Judgement {
  std::array<double, kProbabilities.size()> moment{}, entropy{};
  void add(const GuideVertex& vertex, const Map& map) {
    if (!(vertex.contribution > 0.0f)) return;
    const double guided = density(map, vertex.direction), contribution = vertex.contribution;
    for (std::size_t i = 0; i < kProbabilities.size(); ++i) {
      const double pdf = vertex.bsdf_pdf + kProbabilities[i] * vertex.share * (guided - vertex.bsdf_pdf);
      if (!(pdf > 0.0)) continue;
      moment[i] += contribution * contribution * vertex.pdf / pdf;
      entropy[i] -= contribution * std::log(pdf / vertex.pdf);
    }
  }
};

// The maps of a part of space: of either half of the paths, by which the other one judges it, and of both.
struct Maps {
  Map half[2], both;
};

class Learner {
public:
  Learner(const std::vector<GuideVertex>& of, const Tree& over)
      : maps(over.leaves.size() * gpu::kGuideMapQuads),
        judgements(over.leaves.size()),
        vertices_(of),
        tree_(over),
        directions_(of.size()) {
    tbb::parallel_for(std::size_t{0}, of.size(), [&](std::size_t i) {
      const GuideVertex& v = of[over.order[i].vertex];
      directions_[i] = {double{v.radiance} / v.pdf, cell_of(v.direction), v.odd};
    });
    learn(0, {{even_map(), even_map()}, even_map()});
  }

  Map maps; // of all leaves
  std::vector<Judgement> judgements;

private:
  void learn(std::uint32_t index, const Maps& larger) {
    const Node& node = tree_.nodes[index];
    Histogram halves[2];
    for (std::size_t i = node.first; i < node.last; ++i)
      if (directions_[i].weight > 0.0) halves[directions_[i].odd].add(directions_[i].cell, directions_[i].weight);
    Maps own;
    for (const int half : {0, 1}) own.half[half] = make_map(halves[half], larger.half[half]);
    halves[0].add(halves[1]);
    own.both = make_map(halves[0], larger.both);
    if (node.axis >= 0) {
      tbb::parallel_invoke([&] { learn(node.child, own); }, [&] { learn(node.child + 1, own); });
      return;
    }
    std::ranges::copy(own.both, maps.begin() + static_cast<std::ptrdiff_t>(node.first_leaf * gpu::kGuideMapQuads));
    for (std::size_t i = node.first; i < node.last; ++i)
      judgements[node.first_leaf].add(vertices_[tree_.order[i].vertex], own.half[!directions_[i].odd]);
  }

  struct Direction {
    double weight;
    std::uint32_t cell;
    bool odd;
  };
  const std::vector<GuideVertex>& vertices_;
  const Tree& tree_;
  std::vector<Direction> directions_; // in the order of the tree
};

} // namespace

GuideField no_field() {
  GuideField field;
  field.nodes = {{glm::vec3(0.0f), gpu::kGuideLeafAxis}};
  field.maps = even_map();
  return field;
}

GuideField build_field(const std::vector<GuideVertex>& vertices) {
  if (vertices.empty()) return no_field();
  const Tree tree = make_tree(vertices);
  Learner learner(vertices, tree);
  Judgement all;
  for (const Judgement& leaf : learner.judgements)
    for (std::size_t i = 0; i < kProbabilities.size(); ++i) all.entropy[i] += leaf.entropy[i];
  // What a leaf says of itself, and a little of what all say.
  const double share = kCommon / static_cast<double>(tree.leaves.size());
  std::vector<float> probabilities;
  GuideField field;
  double before = 0.0, after = 0.0;
  for (std::size_t leaf = 0; leaf < tree.leaves.size(); ++leaf) {
    Judgement judged = learner.judgements[leaf];
    for (std::size_t i = 0; i < kProbabilities.size(); ++i) judged.entropy[i] += share * all.entropy[i];
    const auto best = static_cast<std::size_t>(std::ranges::min_element(judged.entropy) - judged.entropy.begin());
    const Node& node = tree.nodes[tree.leaves[leaf]];
    probabilities.push_back(static_cast<float>(kProbabilities[best]));
    field.probability +=
        kProbabilities[best] * static_cast<double>(node.last - node.first) / static_cast<double>(vertices.size());
    before += judged.moment[0], after += judged.moment[best];
  }
  field.gain = before > 0.0 ? after / before : 1.0;
  field.maps = std::move(learner.maps);
  field.nodes.resize(1);
  flatten(tree, probabilities, 0, 0, field.nodes);
  return field;
}

} // namespace wavepath
