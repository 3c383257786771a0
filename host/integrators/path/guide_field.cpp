#include "host/integrators/path/guide_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <span>

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include "host/integrators/path/guide_map.h"

namespace wavepath {
namespace {

constexpr std::size_t kLeafVertices = 300; // vertices of a leaf, except for ties; a part with twice as many is halved
constexpr double kCommon = 0.1;            // weight of all leaves in the choice of the probability of one
constexpr std::array<double, 5> kProbabilities = {0.0, 0.15, 0.3, 0.45, 0.6};

// A part of space: the vertices [first, last) of the order. Halved at `plane` along `axis` into the nodes `child` and
// child + 1; a leaf has no axis.
struct Node {
  std::size_t first = 0, last = 0;
  int axis = -1;
  float plane = 0.0f;
  std::uint32_t child = 0;
  std::uint32_t first_leaf = 0, last_leaf = 0; // leaves below it
};

// A vertex while space is divided, small enough that sorting stays in the caches.
struct Point {
  glm::vec3 position;
  std::uint32_t vertex;
};

struct Tree {
  std::vector<Point> order;
  std::vector<Node> nodes;           // nodes[0] is the root
  std::vector<std::uint32_t> leaves; // nodes of the leaves
};

// Axis of the largest extent; -1 if all points coincide.
int longest_axis(std::span<const Point> part) {
  glm::vec3 lo = part.front().position, hi = lo;
  for (const Point& p : part) lo = glm::min(lo, p.position), hi = glm::max(hi, p.position);
  const glm::vec3 size = hi - lo;
  const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
  return size[axis] > 0.0f ? axis : -1;
}

// Halves a part at the median, with ties above it, or below if nothing else is left above. Returns false if all points
// coincide.
bool halve(std::span<Point> part, Node& node, std::size_t& below) {
  node.axis = longest_axis(part);
  if (node.axis < 0) return false;
  const auto key = [&](const Point& p) { return p.position[node.axis]; };
  const auto middle = part.begin() + static_cast<std::ptrdiff_t>(part.size() / 2);
  std::ranges::nth_element(part, middle, {}, key);
  node.plane = key(*middle);
  if (node.plane == key(*std::ranges::min_element(part.begin(), middle + 1, {}, key))) {
    const float tie = node.plane;
    node.plane = std::numeric_limits<float>::infinity();
    for (const Point& p : part)
      if (key(p) > tie) node.plane = std::min(node.plane, key(p));
  }
  const auto upper = std::partition(part.begin(), part.end(), [&](const Point& p) { return key(p) < node.plane; });
  below = static_cast<std::size_t>(upper - part.begin());
  return below > 0 && below < part.size();
}

// Divides a node and those below, on several threads.
struct Part {
  Node node;
  std::unique_ptr<Part> halves[2];
};

// Divides space into at most `most_leaves` leaves.
void divide(std::uint32_t most_leaves, std::span<Point> order, Part& part) {
  Node& node = part.node;
  const std::size_t size = node.last - node.first;
  std::size_t below = 0;
  if (size < 2 * kLeafVertices || most_leaves < 2 || !halve(order.subspan(node.first, size), node, below)) {
    node.axis = -1;
    return;
  }
  for (auto& half : part.halves) half = std::make_unique<Part>();
  part.halves[0]->node = {.first = node.first, .last = node.first + below};
  part.halves[1]->node = {.first = node.first + below, .last = node.last};
  const std::uint32_t leaves[] = {most_leaves / 2, most_leaves - most_leaves / 2};
  const auto half = [&](int which) { return [&, which] { divide(leaves[which], order, *part.halves[which]); }; };
  constexpr std::size_t kWorthTasks = 8192; // vertices
  if (size < kWorthTasks)
    half(0)(), half(1)();
  else
    tbb::parallel_invoke(half(0), half(1));
}

void number(const Part& part, Tree& tree, std::uint32_t index) {
  Node node = part.node;
  node.first_leaf = static_cast<std::uint32_t>(tree.leaves.size());
  if (node.axis < 0) {
    tree.leaves.push_back(index);
  } else {
    node.child = static_cast<std::uint32_t>(tree.nodes.size());
    tree.nodes.resize(tree.nodes.size() + 2);
    for (std::uint32_t half = 0; half < 2; ++half) number(*part.halves[half], tree, node.child + half);
  }
  node.last_leaf = static_cast<std::uint32_t>(tree.leaves.size());
  tree.nodes[index] = node;
}

Tree make_tree(std::span<const GuideVertex> vertices) {
  Tree tree;
  tree.order.reserve(vertices.size());
  for (std::uint32_t i = 0; i < vertices.size(); ++i) tree.order.push_back({vertices[i].position, i});
  Part whole{.node = {.first = 0, .last = vertices.size()}, .halves = {}};
  divide(kMostGuideLeaves, tree.order, whole);
  tree.nodes.resize(1);
  number(whole, tree, 0);
  return tree;
}

// The tree as kernels read it, two levels in a node. A leaf that ends at the first level appears twice.
void flatten(const Tree& tree, const std::vector<float>& probabilities, std::uint32_t index, std::size_t target,
             std::vector<gpu::GuideNode>& flat) {
  const Node& node = tree.nodes[index];
  if (node.axis < 0) {
    flat[target] = {glm::vec3(probabilities[node.first_leaf]),
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
  flat[target] = entry;
}

// Moments of the contributions of some vertices as functions of the probability of guiding: second moment, and
// cross-entropy with the density of both techniques.
struct Judgement {
  // `guided`: density of its direction.
  std::array<double, kProbabilities.size()> moment{}, entropy{};
  void add(const GuideVertex& vertex, double guided) {
    if (!(vertex.contribution > 0.0f)) return;
    const double contribution = vertex.contribution;
    for (std::size_t i = 0; i < kProbabilities.size(); ++i) {
      const double pdf = vertex.bsdf_pdf + kProbabilities[i] * vertex.guidable_fraction * (guided - vertex.bsdf_pdf);
      if (!(pdf > 0.0)) continue;
      moment[i] += contribution * contribution * vertex.pdf / pdf;
      entropy[i] -= contribution * std::log(pdf / vertex.pdf);
    }
  }
};

// Maps of a part of space: one of each half of the paths, which the other half judges, and one of both.
struct Maps {
  GuideMap half[2], both;
};

class GuideTrainer {
public:
  GuideTrainer(std::span<const GuideVertex> of, const Tree& over)
      : maps(over.leaves.size() * gpu::kGuideMapTexels),
        judgements(over.leaves.size()),
        vertices_(of),
        tree_(over),
        directions_(of.size()) {
    tbb::parallel_for(std::size_t{0}, of.size(), [&](std::size_t i) {
      const GuideVertex& v = of[over.order[i].vertex];
      directions_[i] = {v.radiance / v.pdf, static_cast<std::uint16_t>(map_cell(v.direction)), v.odd};
    });
    train(0, {{even_map(), even_map()}, even_map()});
  }

  std::vector<glm::uvec4> maps; // maps of all leaves
  std::vector<Judgement> judgements;

private:
  void train(std::uint32_t index, const Maps& larger) {
    const Node& node = tree_.nodes[index];
    Histogram halves[2];
    for (std::size_t i = node.first; i < node.last; ++i)
      if (directions_[i].weight > 0.0f) halves[directions_[i].odd].add(directions_[i].cell, directions_[i].weight);
    Maps own;
    for (const int half : {0, 1}) own.half[half] = train_map(halves[half], larger.half[half]);
    halves[0].add(halves[1]);
    own.both = train_map(halves[0], larger.both);
    if (node.axis >= 0) {
      tbb::parallel_invoke([&] { train(node.child, own); }, [&] { train(node.child + 1, own); });
      return;
    }
    write_map(
        own.both,
        std::span(maps).subspan(std::size_t{node.first_leaf} * gpu::kGuideMapTexels).first<gpu::kGuideMapTexels>());
    for (std::size_t i = node.first; i < node.last; ++i) {
      const GuideVertex& vertex = vertices_[tree_.order[i].vertex];
      const Direction& direction = directions_[i];
      judgements[node.first_leaf].add(
          vertex, double{map_density(own.half[!direction.odd], direction.cell)} * map_stretch(vertex.direction));
    }
  }

  struct Direction {
    float weight;
    std::uint16_t cell;
    bool odd;
  };
  std::span<const GuideVertex> vertices_;
  const Tree& tree_;
  std::vector<Direction> directions_; // in the order of the tree
};

} // namespace

GuideField no_field() {
  GuideField field;
  field.nodes = {{glm::vec3(0.0f), gpu::kGuideLeafAxis}};
  field.maps.resize(gpu::kGuideMapTexels);
  write_map(even_map(), std::span(field.maps).first<gpu::kGuideMapTexels>());
  return field;
}

GuideField build_field(std::span<const GuideVertex> vertices) {
  if (vertices.empty()) return no_field();
  const Tree tree = make_tree(vertices);
  GuideTrainer trainer(vertices, tree);
  Judgement all;
  for (const Judgement& leaf : trainer.judgements)
    for (std::size_t i = 0; i < kProbabilities.size(); ++i) all.entropy[i] += leaf.entropy[i];
  // The leaf's own moments, and a small part of those of all leaves.
  const double fraction = kCommon / static_cast<double>(tree.leaves.size());
  std::vector<float> probabilities;
  GuideField field;
  double before = 0.0, after = 0.0;
  for (std::size_t leaf = 0; leaf < tree.leaves.size(); ++leaf) {
    Judgement judged = trainer.judgements[leaf];
    for (std::size_t i = 0; i < kProbabilities.size(); ++i) judged.entropy[i] += fraction * all.entropy[i];
    const auto best = static_cast<std::size_t>(std::ranges::min_element(judged.entropy) - judged.entropy.begin());
    const Node& node = tree.nodes[tree.leaves[leaf]];
    probabilities.push_back(static_cast<float>(kProbabilities[best]));
    field.probability +=
        kProbabilities[best] * static_cast<double>(node.last - node.first) / static_cast<double>(vertices.size());
    before += judged.moment[0], after += judged.moment[best];
  }
  field.gain = before > 0.0 ? after / before : 1.0;
  field.maps = std::move(trainer.maps);
  field.nodes.resize(1);
  flatten(tree, probabilities, 0, 0, field.nodes);
  return field;
}

} // namespace wavepath
