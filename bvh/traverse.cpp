// Closest and any hit of a tree over plain triangles.
#include "bvh/traverse.h"

namespace wavepath::bvh {

Hit closest_hit(const WideTree& tree, std::span<const Triangle> triangles, const Ray& ray, Counters* counters) {
  const PreparedRay prepared = prepare(ray);
  Hit hit;
  const auto leaf = [&](std::uint32_t first, std::uint32_t count, float& t_best) {
    test_leaf(prepared, triangles, tree.order, first, count, t_best, hit);
    return false;
  };
  traverse(tree.nodes, 0, prepared, Order::nearest_first, leaf, counters);
  return hit;
}

bool any_hit(const WideTree& tree, std::span<const Triangle> triangles, const Ray& ray, Counters* counters) {
  const PreparedRay prepared = prepare(ray);
  Hit hit;
  const auto leaf = [&](std::uint32_t first, std::uint32_t count, float& t_best) {
    test_leaf(prepared, triangles, tree.order, first, count, t_best, hit);
    return hit.item != kAbsent;
  };
  traverse(tree.nodes, 0, prepared, Order::largest_first, leaf, counters);
  return hit.item != kAbsent;
}

} // namespace wavepath::bvh
