// Reference traversal on the CPU, which tests compare with the kernels: the same visits in the same order, the same
// rounding and ties.
//
// Algorithm. A stack holds groups of pending siblings, nearest on top; pending leaves are in a list of their own.
// Repeat:
//
//     1. Visit nodes until at least two leaves are pending or no node is left.
//     2. Test all pending leaves, the latest first.
//
// A visit of a node does three things. It appends the leaves that the ray enters, highest slot first, so that the
// lowest is tested first. It pushes the inner children that the ray enters as one group, nearest first; any-hit rays
// take the highest slot first, which is the largest child. It then pops the first child of the topmost group.
//
// Postponed leaves cost a ray 2 % more visits and 10 % more tests, but lanes of a subgroup then visit nodes together
// far more often. Pending entries are not compared with t_best again. Closest hit: a candidate replaces the best if t <
// best, or if t == best and its primitive has the lower index. So the answer depends neither on the order of visits nor
// on the tree. Only hits with t < t_max count.
#pragma once

#include <cassert>
#include <span>

#include "bvh/intersect.h"
#include "bvh/words.h"

namespace wavepath::bvh {

// Counts of work, for benchmarks and budgets: nodes visited, and items in leaves reached.
struct Counters {
  std::uint64_t visits = 0, tests = 0;
};

enum class Order { nearest_first, largest_first };

// Pending siblings: their slots, the next one first.
struct SiblingGroup {
  std::uint32_t first_child;
  std::uint32_t count;
  std::uint32_t slots[4];
};

inline SiblingGroup order_children(const WideNode& node, const Entered& entered, Order order) {
  SiblingGroup group{node.first_child, 0, {}};
  for (std::uint32_t slot = 0; slot < 4; ++slot) {
    if (!(entered.inner >> slot & 1u)) continue;
    std::uint32_t index = group.count++;
    // Distances are compared without their two lowest bits, which carry the slot on devices.
    const auto before = [&](std::uint32_t other) {
      return order == Order::largest_first || entered.t_bits[slot] >> 2 < entered.t_bits[other] >> 2;
    };
    for (; index > 0 && before(group.slots[index - 1]); --index) group.slots[index] = group.slots[index - 1];
    group.slots[index] = slot;
  }
  return group;
}

// Visits the leaves that `ray` enters below node `root`. `leaf(first_item, item_count, t_best)` may lower t_best, which
// starts at ray.t_max, and returns true to end the traversal.
template <class Leaf>
void traverse(std::span<const WideNode> nodes, std::uint32_t root, const PreparedRay& ray, Order order, Leaf&& leaf,
              Counters* counters = nullptr) {
  if (!ray.valid) return;
  struct WaitingLeaf {
    std::uint32_t first, count;
  };
  SiblingGroup stack[kMaxDepth];
  WaitingLeaf leaves[5];
  std::uint32_t stack_size = 0, leaf_count = 0;
  std::uint32_t current = root;
  float t_best = ray.t_max;
  for (;;) {
    while (current != kAbsent && leaf_count < 2) {
      const WideNode& node = nodes[current];
      if (counters) ++counters->visits;
      const Entered entered = enter_children(node, ray, t_best);
      for (std::uint32_t slot = 4; slot-- > 0;)
        if (entered.leaves >> slot & 1u) leaves[leaf_count++] = {first_item(node, slot), item_count(node, slot)};
      const SiblingGroup group = order_children(node, entered, order);
      if (group.count > 0) {
        assert(stack_size < kMaxDepth);
        stack[stack_size++] = group;
      }
      current = kAbsent;
      if (stack_size > 0) {
        SiblingGroup& next = stack[stack_size - 1];
        current = next.first_child + next.slots[0];
        std::copy(next.slots + 1, next.slots + next.count, next.slots);
        if (--next.count == 0) --stack_size;
      }
    }
    while (leaf_count > 0) {
      const WaitingLeaf& next = leaves[--leaf_count];
      if (counters) counters->tests += next.count;
      if (leaf(next.first, next.count, t_best)) return;
    }
    if (current == kAbsent) return;
  }
}

struct Hit {
  std::uint32_t item = kAbsent; // index into the triangles in leaf order, of any copy; kAbsent = miss
  TriangleHit triangle{};       // undefined on a miss
};

// Argument `leaf` of traverse() for closest hits. `triangles`: in leaf order; triangle k is primitive order[k].
inline void test_leaf(const PreparedRay& ray, std::span<const Triangle> triangles, std::span<const std::uint32_t> order,
                      std::uint32_t first, std::uint32_t count, float& t_best, Hit& hit) {
  for (std::uint32_t item = first; item < first + count; ++item) {
    TriangleHit candidate;
    if (!intersect(ray, triangles[item], candidate)) continue;
    if (candidate.t < t_best || (candidate.t == t_best && hit.item != kAbsent && order[item] < order[hit.item])) {
      t_best = candidate.t;
      hit = {item, candidate};
    }
  }
}

// Closest hit, on the front or the back; of equal t, the primitive with the lowest index.
Hit closest_hit(const WideTree& tree, std::span<const Triangle> triangles, const Ray& ray,
                Counters* counters = nullptr);

// True if anything is hit before t_max.
bool any_hit(const WideTree& tree, std::span<const Triangle> triangles, const Ray& ray, Counters* counters = nullptr);

} // namespace wavepath::bvh
