// The CPU reference traversal of a 4-wide tree, the oracle of the kernels: same order, same rounding, same ties.
//
// Recipe. current = root; repeat: if `current` is an inner node, enter_children() gives four keys; sort them ascending
// (sort_keys(): network (0,1)(2,3)(0,2)(1,3)(1,2) with min and max); push the entered children of ranks 3, 2, 1 in that
// order; current = the child of rank 0, or pop if none was entered. If `current` is a leaf, test its items in ascending
// order, then pop. An empty stack ends it. A popped node is not tested against t_best again: its children will be.
// Closest hit: a candidate replaces the best if t < best, or t == best and its item is lower, so that the answer does
// not depend on the order of visits. Only t < t_max counts.
#pragma once

#include <cassert>
#include <span>

#include "bvh/intersect.h"
#include "bvh/words.h"

namespace wavepath::bvh {

// Work done, for benchmarks and budgets: inner nodes visited, items in the leaves reached.
struct Counters {
  std::uint64_t visits = 0, tests = 0;
};

inline void sort_keys(std::uint32_t keys[4]) {
  const auto order = [keys](int i, int j) {
    const std::uint32_t lower = std::min(keys[i], keys[j]), upper = std::max(keys[i], keys[j]);
    keys[i] = lower;
    keys[j] = upper;
  };
  order(0, 1), order(2, 3), order(0, 2), order(1, 3), order(1, 2);
}

// Visits the leaves that `ray` enters, nearest first, from child word `root`. `leaf(first_item, item_count, t_best)`
// may lower t_best, which starts at ray.t_max, and returns true to end the traversal. The stack bound of the tree below
// `root` must not exceed kMaxStackBound, which build() guarantees.
template <class Leaf>
void traverse(std::span<const WideNode> nodes, std::uint32_t root, const PreparedRay& ray, Leaf&& leaf,
              Counters* counters = nullptr) {
  if (!ray.valid || root == kAbsent) return;
  std::uint32_t stack[kMaxStackBound];
  std::uint32_t stack_size = 0;
  std::uint32_t current = root;
  float t_best = ray.t_max;
  for (;;) {
    if (!is_leaf(current)) {
      const WideNode& node = nodes[current];
      if (counters) ++counters->visits;
      std::uint32_t keys[4];
      enter_children(node, ray, t_best, keys);
      sort_keys(keys);
      for (int rank = 3; rank > 0; --rank)
        if (keys[rank] != kMissedKey) {
          assert(stack_size < kMaxStackBound);
          stack[stack_size++] = node.child[keys[rank] & 3u];
        }
      if (keys[0] != kMissedKey) {
        current = node.child[keys[0] & 3u];
        continue;
      }
    } else {
      const std::uint32_t count = leaf_count(current);
      if (counters) counters->tests += count;
      if (leaf(leaf_first(current), count, t_best)) return;
    }
    if (stack_size == 0) return;
    current = stack[--stack_size];
  }
}

struct Hit {
  std::uint32_t item = kAbsent; // index into the triangles in leaf order; kAbsent = miss
  TriangleHit triangle{};       // meaningless on a miss
};

// `leaf` of traverse() for the closest of `triangles` (in leaf order: triangle k is primitive order[k]).
inline void test_leaf(const PreparedRay& ray, std::span<const Triangle> triangles, std::uint32_t first,
                      std::uint32_t count, float& t_best, Hit& hit) {
  for (std::uint32_t item = first; item < first + count; ++item) {
    TriangleHit candidate;
    if (!intersect(ray, triangles[item], candidate)) continue;
    if (candidate.t < t_best || (candidate.t == t_best && hit.item != kAbsent && item < hit.item)) {
      t_best = candidate.t;
      hit = {item, candidate};
    }
  }
}

// Closest hit, front or back; ties go to the lowest item.
Hit closest_hit(const WideTree& tree, std::span<const Triangle> triangles, const Ray& ray,
                Counters* counters = nullptr);

// Whether anything is hit before t_max.
bool any_hit(const WideTree& tree, std::span<const Triangle> triangles, const Ray& ray, Counters* counters = nullptr);

} // namespace wavepath::bvh
