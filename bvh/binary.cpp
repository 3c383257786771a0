// Top-down build of the binary tree: tasks for large nodes, plain recursion for small ones. Primitives move between two
// buffers at each cut (a stable partition), so that the outcome is the same for any number of threads. For spatial
// splits the buffers have spare capacity, which each cut divides between its sides in proportion to what splits may
// save there: the bound on copies then holds without a counter shared by threads.
#include "bvh/binary.h"

#include <atomic>
#include <bit>
#include <numeric>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>

#include "bvh/primitives.h"
#include "bvh/spatial.h"

namespace wavepath::bvh {

namespace {

constexpr std::uint32_t kTaskSize = 4096;      // nodes with fewer items get no task of their own
constexpr std::uint32_t kParallelSize = 65536; // nodes with more items are binned and partitioned by several threads,
constexpr std::uint32_t kBlockSize = 16384;    // in blocks of so many items

// Spatial splits are tried if the sides of the best cut overlap by more than this fraction of the root's area (by
// quality), and by this fraction of the node on every axis: boxes that merely touch share a whole face. Work a ray on
// Sponza is 28.5 % less with 3e-3 and 29 % less with 1e-4, in 1.7x and 3.2x the time of a build without reinsertion.
// With 1e-5 and no limit on thinness it is 29 % less in 5x the time; terrain, where splits gain nothing, takes 4x. 1e-3
// takes 1.1x the time of 3e-3 and finds more of the detail that is small beside the scene: the showcase's bounce rays
// make 10.3 tests instead of 12.7.
constexpr double kMinSharedArea[] = {std::numeric_limits<double>::infinity(), 1e-3, 1e-4};
constexpr float kMinSharedPart = 0.01f;

// A node to be built over the primitives [begin, end) of one of the two buffers. Copies may extend the range up to
// `capacity`.
struct Work {
  std::uint32_t node, begin, end, capacity, depth;
  Bound bound, centroids;
  Primitive *primitives, *scratch; // both hold the whole set

  std::uint32_t count() const { return end - begin; }
  std::uint32_t spare() const { return capacity - end; }
  std::span<Primitive> items() const { return {primitives + begin, count()}; }
};

// Allocates pairs of nodes for one task from a chunk of its own. A task of n items needs at most 2n - 2 nodes.
struct NodePool {
  std::uint32_t next = 0, end = 0, needed = 0;
};

// The cheapest cuts of a node.
struct Cuts {
  Cut between; // primitives
  SpatialCut through;
  float cost() const { return std::min(between.cost, through.cost); }
};

struct Builder {
  BuildConfig config;
  std::span<const Triangle> triangles; // for spatial splits
  double least_shared_area;            // overlap above which spatial splits are tried
  BinaryNode* nodes;
  std::uint32_t* order;
  std::atomic<std::uint32_t> node_count{2}; // siblings share a cache line: their indices are even and odd

  std::uint32_t build(const Work& work);
  std::uint32_t build_small(const Work& work, NodePool& pool);
  Cuts find_cuts(const Work& work, const Slabs& slabs) const;
  std::pair<Work, Work> cut_in_two(const Work& work, const Slabs& slabs, const Cuts& cuts) const;
  bool divide_space(const Work& work, const Slabs& slabs, const SpatialCut& cut, std::pair<Work, Work>& sides) const;
  void fill_leaf(const Work& work);
  bool make_leaf(const Work& work, const Slabs& slabs, float cut_cost);
  std::uint32_t make_inner(const Work& work, std::uint32_t children, std::uint32_t child_height);
};

std::uint32_t ceil_log2(std::uint32_t n) { return static_cast<std::uint32_t>(std::bit_width(n - 1)); }

void grow(std::span<const Primitive> items, Bound& bound, Bound& centroids) {
  for (const Primitive& item : items) {
    bound.merge(item.bound);
    centroids.merge(item.centroid_bound());
  }
}

Slabs slabs_of(const Work& work, const BuildConfig& config) {
  // A node of few items uses few slabs: a sweep over more costs more than it gains.
  return {work.bound, work.centroids, static_cast<int>(std::min(config.bin_count, work.count() / 4 + 2))};
}

// Returns make() with all items added by add(bins, items); uses several threads if there are many.
template <class Make, class Add, class Merge>
auto fill_bins(const Work& work, const Make& make, const Add& add, const Merge& merge) {
  if (work.count() < kParallelSize) {
    auto bins = make(); // built in place: copying the slabs takes a tenth of the time of small nodes
    add(bins, work.items());
    return bins;
  }
  const auto add_range = [&](const tbb::blocked_range<std::uint32_t>& range, auto sum) {
    add(sum, work.items().subspan(range.begin(), range.size()));
    return sum;
  };
  const auto join = [&](auto a, const auto& b) {
    merge(a, b);
    return a;
  };
  return tbb::parallel_reduce(tbb::blocked_range<std::uint32_t>(0, work.count(), kBlockSize), make(), add_range, join);
}

Cut find_cut(const Work& work, const Slabs& slabs) {
  const std::span<const Primitive> items = work.items();
  if (items.size() == 2) return best_cut_of_two(slabs, items[0], items[1]);
  if (items.size() == 3) return best_cut_of_three(slabs, items.first<3>());
  const auto make = [&] { return Bins(slabs); };
  const auto add = [&](Bins& bins, std::span<const Primitive> some) { bins.add(slabs, some); };
  const auto merge = [&](Bins& bins, const Bins& other) { bins.merge(slabs, other); };
  return fill_bins(work, make, add, merge).best_cut(slabs);
}

SpatialCut find_spatial_cut(const Work& work, std::span<const Triangle> triangles, float inverse_size) {
  const SpatialSlabs slabs(work.bound);
  const auto make = [] { return SpatialBins{}; };
  const auto add = [&](SpatialBins& bins, std::span<const Primitive> items) { bins.add(slabs, items, triangles); };
  const auto merge = [](SpatialBins& bins, const SpatialBins& other) { bins.merge(other); };
  return fill_bins(work, make, add, merge).best_cut(slabs, inverse_size, work.count() + work.spare());
}

// True if the boxes of the two sides overlap enough to try a spatial split, or if there is no cut.
bool overlap(const Work& work, const Cut& cut, double least_area) {
  if (cut.left_count == 0) return true;
  Bound shared;
  for (int i = 0; i < 8; ++i) shared.lane[i] = std::min(cut.left.lane[i], cut.right.lane[i]);
  for (int axis = 0; axis < 3; ++axis)
    if (shared.extent(axis) < kMinSharedPart * work.bound.extent(axis)) return false;
  return half_area(shared.box()) > least_area;
}

Cuts Builder::find_cuts(const Work& work, const Slabs& slabs) const {
  Cuts cuts{find_cut(work, slabs), {}};
  if (work.spare() > 0 && overlap(work, cuts.between, least_shared_area))
    cuts.through = find_spatial_cut(work, triangles, slabs.inverse_size);
  return cuts;
}

// The two sides of a cut during partitioning.
struct Sides {
  Primitive* end[2];  // end of the items appended so far
  Bound centroids[2]; // of the items appended so far
};

// Appends each item to its side, in order. The side is an index rather than a branch, which would be mispredicted half
// the time, and the centroids' boxes stay in registers: a centroid becomes not-a-number, which no minimum or maximum
// takes, for the side where it does not belong.
void scatter(std::span<const Primitive> items, const Slabs& slabs, const Cut& cut, Sides& sides) {
  Primitive *left = sides.end[0], *right = sides.end[1];
  Lanes least[2], most[2];
  least[0] = least[1] = splat(-Bound::kEmpty);
  most[0] = most[1] = splat(Bound::kEmpty);
  const float lo = slabs.lo[cut.axis], scale = slabs.scale[cut.axis];
  const Lanes slab = splat(static_cast<float>(cut.slab));
  for (const Primitive& item : items) {
    const IntLanes belongs_right = splat((item.centroid(cut.axis) - lo) * scale) >= slab; // as Slabs::of()
    const Lanes centroid = item.centroid();
    const IntLanes bits = std::bit_cast<IntLanes>(centroid);
    const Lanes of_left = std::bit_cast<Lanes>(bits | belongs_right),
                of_right = std::bit_cast<Lanes>(bits | ~belongs_right);
    least[0] = smaller(of_left, least[0]);
    most[0] = larger(of_left, most[0]);
    least[1] = smaller(of_right, least[1]);
    most[1] = larger(of_right, most[1]);
    const std::ptrdiff_t one_right = belongs_right[0] & 1;
    *(one_right != 0 ? right : left) = item;
    left += 1 - one_right;
    right += one_right;
  }
  sides = {{left, right}, {{-least[0], most[0]}, {-least[1], most[1]}}};
}

// The same by several threads: each block knows how many items of earlier blocks go left.
void scatter_parallel(const Work& work, const Slabs& slabs, const Cut& cut, Sides& sides) {
  const std::uint32_t block_count = (work.count() + kBlockSize - 1) / kBlockSize;
  const auto block_items = [&](std::uint32_t block) {
    const std::uint32_t first = block * kBlockSize;
    return work.items().subspan(first, std::min(kBlockSize, work.count() - first));
  };
  std::vector<std::uint32_t> left_before(block_count + 1, 0);
  tbb::parallel_for(0u, block_count, [&](std::uint32_t b) {
    for (const Primitive& item : block_items(b)) left_before[b + 1] += slabs.of(item, cut.axis) < cut.slab;
  });
  std::partial_sum(left_before.begin(), left_before.end(), left_before.begin());
  std::vector<Sides> blocks(block_count);
  tbb::parallel_for(0u, block_count, [&](std::uint32_t b) {
    const std::uint32_t right_before = b * kBlockSize - left_before[b];
    blocks[b] = {{sides.end[0] + left_before[b], sides.end[1] + right_before}, {}};
    scatter(block_items(b), slabs, cut, blocks[b]);
  });
  for (const Sides& block : blocks)
    for (int side = 0; side < 2; ++side) sides.centroids[side].merge(block.centroids[side]);
}

// Fraction of the spare capacity that is divided by counts, in case that slack tells nothing.
constexpr double kSharedByCount = 0.0625;

// Index at which the right side begins. The spare capacity is divided by the slack of the items; left_part(item) is the
// part of it that goes left. If it were divided by counts, a few long triangles among many small ones would get next to
// none. The order of summation does not depend on the number of threads.
template <class LeftPart>
std::uint32_t middle_of(const Work& work, std::uint32_t left_count, std::uint32_t right_count,
                        const LeftPart& left_part) {
  const std::uint32_t spare = work.capacity - work.begin - left_count - right_count;
  if (spare == 0) return work.begin + left_count;
  struct Slack {
    double left = 0.0, all = 0.0;
  };
  const auto add_range = [&](const tbb::blocked_range<std::uint32_t>& range, Slack sum) {
    for (const Primitive& item : work.items().subspan(range.begin(), range.size())) {
      const double slack = item.slack();
      sum.left += slack * left_part(item);
      sum.all += slack;
    }
    return sum;
  };
  const auto join = [](const Slack& a, const Slack& b) { return Slack{a.left + b.left, a.all + b.all}; };
  const tbb::blocked_range<std::uint32_t> range(0, work.count(), kBlockSize);
  const Slack slack = work.count() < kParallelSize
                          ? add_range(range, Slack{})
                          : tbb::parallel_deterministic_reduce(range, Slack{}, add_range, join);
  const double by_count = static_cast<double>(left_count) / (left_count + right_count);
  const double by_slack = slack.all > 0.0 ? std::min(slack.left / slack.all, 1.0) : by_count;
  const double part = kSharedByCount * by_count + (1.0 - kSharedByCount) * by_slack;
  return work.begin + left_count + static_cast<std::uint32_t>(part * spare);
}

std::pair<Work, Work> divide(const Work& work, const Slabs& slabs, const Cut& cut) {
  const std::uint32_t right_count = work.count() - cut.left_count;
  const auto left_part = [&](const Primitive& item) { return slabs.of(item, cut.axis) < cut.slab ? 1.0 : 0.0; };
  const std::uint32_t middle = middle_of(work, cut.left_count, right_count, left_part);
  Sides sides{{work.scratch + work.begin, work.scratch + middle}, {}};
  if (work.count() < kParallelSize)
    scatter(work.items(), slabs, cut, sides);
  else
    scatter_parallel(work, slabs, cut, sides);
  return {{0, work.begin, work.begin + cut.left_count, middle, work.depth + 1, cut.left, sides.centroids[0],
           work.scratch, work.primitives},
          {0, middle, middle + right_count, work.capacity, work.depth + 1, cut.right, sides.centroids[1], work.scratch,
           work.primitives}};
}

// Returns false and leaves `work` unchanged if one side is empty.
bool Builder::divide_space(const Work& work, const Slabs& slabs, const SpatialCut& cut,
                           std::pair<Work, Work>& sides) const {
  const SpatialSlabs spatial_slabs(work.bound);
  const auto left_part = [&](const Primitive& item) {
    const bool in_left = spatial_slabs.first(item, cut.axis) < cut.slab,
               in_right = spatial_slabs.last(item, cut.axis) >= cut.slab;
    return in_left && in_right ? 0.5 : in_left ? 1.0 : 0.0;
  };
  const std::uint32_t middle = middle_of(work, cut.left_count, cut.right_count, left_part);
  Work left{0, work.begin, work.begin, middle, work.depth + 1, {}, {}, work.scratch, work.primitives};
  Work right{0, middle, middle, work.capacity, work.depth + 1, {}, {}, work.scratch, work.primitives};
  const auto put = [](Work& side, const Primitive& item) {
    side.primitives[side.end++] = item;
    side.bound.merge(item.bound);
    side.centroids.merge(item.centroid_bound());
  };
  for (const Primitive& item : work.items()) {
    const bool whole = !config.whole.empty() && config.whole[item.index()] != 0;
    const Pieces pieces =
        wavepath::bvh::divide(item, triangles[item.index()], whole, spatial_slabs, cut, slabs.inverse_size);
    if (pieces.in_left) put(left, pieces.left);
    if (pieces.in_right) put(right, pieces.right);
  }
  sides = {left, right};
  return left.count() > 0 && right.count() > 0;
}

// Halves by count along the longest axis of the centroids, or in the present order if all centroids are equal.
std::pair<Work, Work> halve(const Work& work) {
  int axis = work.centroids.extent(1) > work.centroids.extent(0) ? 1 : 0;
  if (work.centroids.extent(2) > work.centroids.extent(axis)) axis = 2;
  const std::span<Primitive> items = work.items();
  const std::uint32_t half = work.count() / 2;
  if (work.centroids.extent(axis) > 0)
    std::nth_element(items.begin(), items.begin() + half, items.end(), [axis](const Primitive& a, const Primitive& b) {
      return std::pair(a.centroid(axis), a.index()) < std::pair(b.centroid(axis), b.index());
    });
  const std::uint32_t middle = work.begin + half;
  Work left{0, work.begin, middle, middle, work.depth + 1, {}, {}, work.primitives, work.scratch};
  Work right{0, middle, work.end, work.capacity, work.depth + 1, {}, {}, work.primitives, work.scratch};
  grow(left.items(), left.bound, left.centroids);
  grow(right.items(), right.bound, right.centroids);
  return {left, right};
}

// Cuts by area unless there is no such cut or the deeper side could no longer be finished within kMaxBinaryDepth.
std::pair<Work, Work> Builder::cut_in_two(const Work& work, const Slabs& slabs, const Cuts& cuts) const {
  const auto may_cut = [&](std::uint32_t left_count, std::uint32_t right_count) {
    return left_count > 0 && work.depth + 1 + ceil_log2(std::max(left_count, right_count)) <= kMaxBinaryDepth;
  };
  std::pair<Work, Work> sides;
  if (cuts.through.cost < cuts.between.cost && may_cut(cuts.through.left_count, cuts.through.right_count) &&
      divide_space(work, slabs, cuts.through, sides))
    return sides;
  if (!may_cut(cuts.between.left_count, work.count() - cuts.between.left_count)) return halve(work);
  return divide(work, slabs, cuts.between);
}

bool Builder::make_leaf(const Work& work, const Slabs& slabs, float cut_cost) {
  if (work.count() > config.max_leaf_size) return false;
  const float area = half_area(work.bound, slabs.inverse_size);
  if (cut_cost + config.node_cost * area < static_cast<float>(work.count()) * area) return false;
  fill_leaf(work);
  return true;
}

void Builder::fill_leaf(const Work& work) {
  for (std::uint32_t i = work.begin; i < work.end; ++i) order[i] = work.primitives[i].index();
  nodes[work.node] = {work.bound.box(), work.begin, static_cast<std::uint16_t>(work.count()), 0};
}

std::uint32_t Builder::make_inner(const Work& work, std::uint32_t children, std::uint32_t child_height) {
  nodes[work.node] = {work.bound.box(), children, 0, static_cast<std::uint16_t>(child_height + 1)};
  return child_height + 1;
}

std::uint32_t Builder::build_small(const Work& work, NodePool& pool) {
  if (work.count() == 1) {
    fill_leaf(work);
    return 0;
  }
  const Slabs slabs = slabs_of(work, config);
  const Cuts cuts = find_cuts(work, slabs);
  if (make_leaf(work, slabs, cuts.cost())) return 0;
  auto [left, right] = cut_in_two(work, slabs, cuts);
  if (pool.next == pool.end) {
    const std::uint32_t chunk = std::min(pool.needed, 64u);
    pool.next = node_count.fetch_add(chunk);
    pool.end = pool.next + chunk;
    pool.needed -= chunk;
  }
  left.node = pool.next++;
  right.node = pool.next++;
  const std::uint32_t left_height = build_small(left, pool), right_height = build_small(right, pool);
  return make_inner(work, left.node, std::max(left_height, right_height));
}

std::uint32_t Builder::build(const Work& work) {
  if (work.count() < kTaskSize) {
    NodePool pool{0, 0, 2 * (work.capacity - work.begin) - 2};
    return build_small(work, pool);
  }
  const Slabs slabs = slabs_of(work, config);
  auto [left, right] = cut_in_two(work, slabs, find_cuts(work, slabs));
  left.node = node_count.fetch_add(2);
  right.node = left.node + 1;
  std::uint32_t left_height = 0, right_height = 0;
  tbb::parallel_invoke([&, l = left] { left_height = build(l); }, [&, r = right] { right_height = build(r); });
  return make_inner(work, left.node, std::max(left_height, right_height));
}

// Sets the slack of all triangles; those that must stay whole get 0.
void set_slacks(std::span<Primitive> primitives, std::span<const Triangle> triangles, const BuildConfig& config,
                const Bound& bound) {
  const float inverse_size = Slabs(bound, bound, 2).inverse_size;
  const tbb::blocked_range<std::size_t> range(0, primitives.size(), kBlockSize);
  tbb::parallel_for(range, [&](const tbb::blocked_range<std::size_t>& some) {
    for (Primitive& item : primitives.subspan(some.begin(), some.size())) {
      const std::uint32_t index = item.index();
      const bool whole = !config.whole.empty() && config.whole[index] != 0;
      item.set_slack(whole ? 0.0f : slack_of(item, triangles[index], inverse_size));
    }
  });
}

} // namespace

BinaryTree build_binary(std::span<const Box> boxes, std::span<const Triangle> triangles, const BuildConfig& config,
                        BuildReport& report) {
  BinaryTree tree;
  const std::size_t given = boxes.size() + triangles.size(); // one of both is empty
  report = {given, {}, 0};
  if (given == 0) return tree;

  // Pages that are never written take no memory, in any of these.
  const bool splits = config.quality != Quality::fast && !triangles.empty();
  const double spare = splits ? config.max_copies * static_cast<double>(given) : 0.0;
  std::size_t capacity = std::min(given + static_cast<std::size_t>(spare), std::max(given, kMaxItems));
  const auto primitives = make_array<Primitive>(capacity);
  const PrimitiveList list =
      triangles.empty() ? list_primitives(boxes, primitives.get()) : list_primitives(triangles, primitives.get());
  report.dropped -= list.count;
  if (list.count == 0) return tree;
  report.box = list.bound.box();
  if (splits)
    capacity =
        std::min(list.count + static_cast<std::size_t>(config.max_copies * static_cast<double>(list.count)), capacity);
  else
    capacity = list.count;

  if (splits) set_slacks({primitives.get(), list.count}, triangles, config, list.bound);
  const auto scratch = make_array<Primitive>(capacity);
  tree.order = make_array<std::uint32_t>(capacity);
  tree.capacity = 2 * capacity; // the second is not used
  tree.nodes = make_array<BinaryNode>(tree.capacity);
  const Work root{0,
                  0,
                  static_cast<std::uint32_t>(list.count),
                  static_cast<std::uint32_t>(capacity),
                  0,
                  list.bound,
                  list.centroids,
                  primitives.get(),
                  scratch.get()};
  const double least_shared_area = kMinSharedArea[static_cast<int>(config.quality)] * half_area(root.bound.box());
  Builder builder{config, triangles, least_shared_area, tree.nodes.get(), tree.order.get()};
  report.binary_depth = builder.build(root);
  return tree;
}

} // namespace wavepath::bvh
