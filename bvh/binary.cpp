// Top-down build of the binary tree: tasks for large nodes, plain recursion for small ones. Primitives move between two
// buffers at each cut (a stable partition), so that the outcome is the same for any number of threads.
#include "bvh/binary.h"

#include <atomic>
#include <bit>
#include <numeric>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>

#include "bvh/split.h"

namespace wavepath::bvh {

namespace {

constexpr std::uint32_t kTaskSize = 4096;      // smaller nodes are not worth a task
constexpr std::uint32_t kParallelSize = 65536; // larger ones are binned and partitioned by several threads,
constexpr std::uint32_t kBlockSize = 16384;    // in blocks of this many

// A node to be built, over the primitives [begin, end) of one of the two buffers.
struct Work {
  std::uint32_t node, begin, end, depth;
  Bound bound, centroids;
  Primitive *primitives, *scratch; // both hold the whole set

  std::uint32_t count() const { return end - begin; }
  std::span<Primitive> items() const { return {primitives + begin, count()}; }
};

// Hands out pairs of nodes to one task from a chunk of its own. A task of n items needs at most 2n - 2.
struct NodePool {
  std::uint32_t next = 0, end = 0, needed = 0;
};

struct Builder {
  BuildConfig config;
  BinaryNode* nodes;
  std::uint32_t* order;
  std::atomic<std::uint32_t> node_count{1};

  std::uint32_t build(const Work& work);
  std::uint32_t build_small(const Work& work, NodePool& pool);
  bool make_leaf(const Work& work, const Slabs& slabs, const Cut& cut);
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
  // Few items fall into few slabs: the sweep would cost more than it finds.
  return {work.bound, work.centroids, static_cast<int>(std::min(config.bin_count, work.count() / 4 + 2))};
}

Cut find_cut(const Work& work, const Slabs& slabs) {
  if (work.count() < kParallelSize) {
    Bins bins(slabs);
    bins.add(slabs, work.items());
    return bins.best_cut(slabs);
  }
  const auto add = [&](const tbb::blocked_range<std::uint32_t>& range, Bins bins) {
    bins.add(slabs, work.items().subspan(range.begin(), range.size()));
    return bins;
  };
  const auto merge = [&](Bins a, const Bins& b) {
    a.merge(slabs, b);
    return a;
  };
  const tbb::blocked_range<std::uint32_t> all(0, work.count(), kBlockSize);
  return tbb::parallel_reduce(all, Bins(slabs), add, merge).best_cut(slabs);
}

// The two sides of a cut while items move there.
struct Sides {
  Primitive* end[2];  // one past the items already there
  Bound centroids[2]; // of these items
};

// Appends each item to its side, in order. The side is an index rather than a branch, which would be mispredicted half
// the time.
void scatter(std::span<const Primitive> items, const Slabs& slabs, const Cut& cut, Sides& sides) {
  for (const Primitive& item : items) {
    const int side = slabs.of(item, cut.axis) < cut.slab ? 0 : 1;
    sides.centroids[side].merge(item.centroid_bound());
    *sides.end[side]++ = item;
  }
}

// The same by several threads: each block knows how many items before it go left.
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

std::pair<Work, Work> divide(const Work& work, const Slabs& slabs, const Cut& cut) {
  const std::uint32_t middle = work.begin + cut.left_count;
  Sides sides{{work.scratch + work.begin, work.scratch + middle}, {}};
  if (work.count() < kParallelSize)
    scatter(work.items(), slabs, cut, sides);
  else
    scatter_parallel(work, slabs, cut, sides);
  return {{0, work.begin, middle, work.depth + 1, cut.left, sides.centroids[0], work.scratch, work.primitives},
          {0, middle, work.end, work.depth + 1, cut.right, sides.centroids[1], work.scratch, work.primitives}};
}

// Halves by count along the longest axis of the centroids, or as they come if all centroids are equal.
std::pair<Work, Work> halve(const Work& work) {
  int axis = work.centroids.extent(1) > work.centroids.extent(0) ? 1 : 0;
  if (work.centroids.extent(2) > work.centroids.extent(axis)) axis = 2;
  const std::span<Primitive> items = work.items();
  const std::uint32_t half = work.count() / 2;
  if (work.centroids.extent(axis) > 0)
    std::nth_element(items.begin(), items.begin() + half, items.end(), [axis](const Primitive& a, const Primitive& b) {
      return std::pair(a.centroid(axis), a.index()) < std::pair(b.centroid(axis), b.index());
    });
  Work left{0, work.begin, work.begin + half, work.depth + 1, {}, {}, work.primitives, work.scratch};
  Work right{0, left.end, work.end, work.depth + 1, {}, {}, work.primitives, work.scratch};
  grow(left.items(), left.bound, left.centroids);
  grow(right.items(), right.bound, right.centroids);
  return {left, right};
}

// Cuts by area unless there is no such cut or the deeper side could no longer be finished within kMaxBinaryDepth.
std::pair<Work, Work> cut_in_two(const Work& work, const Slabs& slabs, const Cut& cut) {
  const std::uint32_t larger = std::max(cut.left_count, work.count() - cut.left_count);
  if (cut.left_count == 0 || work.depth + 1 + ceil_log2(larger) > kMaxBinaryDepth) return halve(work);
  return divide(work, slabs, cut);
}

bool Builder::make_leaf(const Work& work, const Slabs& slabs, const Cut& cut) {
  if (work.count() > config.max_leaf_size) return false;
  const float area = half_area(work.bound, slabs.inverse_size);
  if (work.count() > 1 && cut.cost + config.node_cost * area < static_cast<float>(work.count()) * area) return false;
  for (std::uint32_t i = work.begin; i < work.end; ++i) order[i] = work.primitives[i].index();
  nodes[work.node] = {work.bound.box(), work.begin, static_cast<std::uint16_t>(work.count()), 0};
  return true;
}

std::uint32_t Builder::make_inner(const Work& work, std::uint32_t children, std::uint32_t child_height) {
  nodes[work.node] = {work.bound.box(), children, 0, static_cast<std::uint16_t>(child_height + 1)};
  return child_height + 1;
}

std::uint32_t Builder::build_small(const Work& work, NodePool& pool) {
  const Slabs slabs = slabs_of(work, config);
  const Cut cut = work.count() > 1 ? find_cut(work, slabs) : Cut{};
  if (make_leaf(work, slabs, cut)) return 0;
  auto [left, right] = cut_in_two(work, slabs, cut);
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
    NodePool pool{0, 0, 2 * work.count() - 2};
    return build_small(work, pool);
  }
  const Slabs slabs = slabs_of(work, config);
  auto [left, right] = cut_in_two(work, slabs, find_cut(work, slabs));
  left.node = node_count.fetch_add(2);
  right.node = left.node + 1;
  std::uint32_t left_height = 0, right_height = 0;
  tbb::parallel_invoke([&, l = left] { left_height = build(l); }, [&, r = right] { right_height = build(r); });
  return make_inner(work, left.node, std::max(left_height, right_height));
}

} // namespace

BinaryTree build_binary(std::span<const Box> boxes, const BuildConfig& config, BuildReport& report) {
  BinaryTree tree;
  std::size_t kept = 0;
  for (const Box& box : boxes) kept += is_valid(box);
  report = {boxes.size() - kept, 0};
  if (kept == 0) return tree;

  const auto primitives = std::make_unique_for_overwrite<Primitive[]>(kept);
  const auto scratch = std::make_unique_for_overwrite<Primitive[]>(kept);
  std::size_t count = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (is_valid(boxes[i])) primitives[count++] = Primitive(boxes[i], static_cast<std::uint32_t>(i));

  tree.order.resize(kept);
  tree.capacity = 2 * kept - 1;
  tree.nodes = std::make_unique_for_overwrite<BinaryNode[]>(tree.capacity); // pages that stay unused cost nothing
  Builder builder{config, tree.nodes.get(), tree.order.data()};
  Work root{0, 0, static_cast<std::uint32_t>(kept), 0, {}, {}, primitives.get(), scratch.get()};
  grow(root.items(), root.bound, root.centroids);
  report.binary_depth = builder.build(root);
  return tree;
}

} // namespace wavepath::bvh
