// Walks over the tree with every index checked, then looks for what the walk did not reach.
#include "bvh/validate.h"

#include <algorithm>
#include <limits>

#include "bvh/coverage.h"
#include "bvh/words.h"

namespace wavepath::bvh {

namespace {

constexpr std::uint32_t kMaxWalk = 1000; // limits the recursion on degenerate input

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct ValidateWalk {
  const WideTree& tree;
  std::vector<std::string> reasons;
  // For each item, the region in which it is met.
  std::vector<GridBox> regions = std::vector<GridBox>(tree.order.size());
  std::vector<bool> node_seen = std::vector<bool>(tree.nodes.size());
  std::vector<bool> item_seen = std::vector<bool>(tree.order.size());
  std::uint32_t depth_seen = 0;

  void fail(std::string reason) {
    if (reasons.size() < kMaxReasons) reasons.push_back(std::move(reason));
  }

  void leaf(std::size_t first, std::size_t count, const GridBox& region) {
    if (first + count > tree.order.size()) {
      fail("leaf of items " + std::to_string(first) + " to " + std::to_string(first + count - 1) + " exceeds the " +
           std::to_string(tree.order.size()) + " items");
      return;
    }
    for (std::size_t item = first; item < first + count; ++item) {
      if (item_seen[item]) fail("item " + std::to_string(item) + " is in more than one leaf");
      item_seen[item] = true;
      regions[item] = region;
    }
  }

  void inner(std::uint32_t index, std::uint32_t depth, const GridBox& region) {
    const std::string name = "node " + std::to_string(index);
    if (index >= tree.nodes.size()) {
      fail(name + " is out of range");
      return;
    }
    if (node_seen[index] || depth > kMaxWalk) {
      fail(name + (node_seen[index] ? " is reached twice" : " lies too deep"));
      return;
    }
    node_seen[index] = true;
    depth_seen = std::max(depth_seen, depth);
    const WideNode& node = tree.nodes[index];
    std::uint32_t child_count = 0;
    for (std::uint32_t slot = 0; slot < 4; ++slot) {
      if (is_inner(node, slot) && is_leaf(node, slot))
        fail("child " + std::to_string(slot) + " of " + name + " is both a node and a leaf");
      if (!is_inner(node, slot) && !is_leaf(node, slot)) continue;
      if (slot != child_count++) fail("child " + std::to_string(slot) + " of " + name + " comes after an absent one");
      const GridBox below = within(region, node, slot);
      if (is_leaf(node, slot))
        leaf(first_item(node, slot), item_count(node, slot), below);
      else
        inner(node.first_child + slot, depth + 1, below);
    }
    if (child_count < 2 && tree.order.size() > kMaxLeafSize) fail(name + " has fewer than two children");
  }

  // Intersects `region` with the child's box, without the margin that the slab test needs.
  static GridBox within(GridBox region, const WideNode& node, std::uint32_t slot) {
    const GridBox box = child_box(node, slot);
    for (int axis = 0; axis < 3; ++axis) {
      const double margin = kGridMargin * double{cell(node, axis)};
      const double lo = box.lo[axis] + margin, hi = box.hi[axis] - margin;
      if (region.lo[axis] < lo || std::isnan(lo)) region.lo[axis] = lo; // once NaN, always NaN
      if (region.hi[axis] > hi || std::isnan(hi)) region.hi[axis] = hi;
    }
    return region;
  }

  void check_nodes() {
    inner(0, 1, {{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}});
    const auto nodes_missed = std::count(node_seen.begin(), node_seen.end(), false);
    const auto items_missed = std::count(item_seen.begin(), item_seen.end(), false);
    if (nodes_missed != 0) fail(std::to_string(nodes_missed) + " nodes are never reached");
    if (items_missed != 0) fail(std::to_string(items_missed) + " items are in no leaf");
    if (tree.depth != depth_seen)
      fail("the depth is " + std::to_string(tree.depth) + " but should be " + std::to_string(depth_seen));
    if (depth_seen > kMaxDepth) fail("the depth " + std::to_string(depth_seen) + " is too large");
  }
};

// Regions of each valid primitive.
std::vector<std::vector<GridBox>> regions_of(ValidateWalk& walk, const std::vector<bool>& valid) {
  std::vector<std::vector<GridBox>> regions(valid.size());
  for (std::size_t item = 0; item < walk.tree.order.size(); ++item) {
    const std::uint32_t primitive = walk.tree.order[item];
    if (primitive >= valid.size() || !valid[primitive])
      walk.fail("order names primitive " + std::to_string(primitive) + ", which is out of range or invalid");
    else if (walk.item_seen[item])
      regions[primitive].push_back(walk.regions[item]);
  }
  return regions;
}

bool contains(const GridBox& region, const Box& box) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(region.lo[axis] <= box.lo[axis] && region.hi[axis] >= box.hi[axis])) return false;
  return true;
}

// Regions reduced by the padding of bounds(), which covers rounding in the triangle test; empty or NaN regions are left
// out.
void shrink(std::vector<GridBox>& regions, const Triangle& triangle) {
  const Vec3 lo = min(triangle.v0, min(triangle.v1, triangle.v2)), hi = max(triangle.v0, max(triangle.v1, triangle.v2));
  const double pad = max_component(hi - lo) * 0x1p-20;
  for (GridBox& region : regions)
    for (int axis = 0; axis < 3; ++axis) {
      region.lo[axis] += pad;
      region.hi[axis] -= pad;
    }
  std::erase_if(regions, [](const GridBox& region) {
    return !(region.lo[0] <= region.hi[0] && region.lo[1] <= region.hi[1] && region.lo[2] <= region.hi[2]);
  });
}

} // namespace

std::vector<std::string> validate(const WideTree& tree, std::span<const Box> boxes) {
  ValidateWalk walk{tree, {}};
  walk.check_nodes();
  std::vector<bool> valid(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) valid[i] = is_valid(boxes[i]);
  const auto regions = regions_of(walk, valid);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!valid[i]) continue;
    const std::string name = "primitive " + std::to_string(i);
    if (regions[i].size() != 1) walk.fail(name + " is in " + std::to_string(regions[i].size()) + " leaves");
    if (regions[i].size() == 1 && !contains(regions[i][0], boxes[i])) walk.fail(name + " sticks out of a box above it");
  }
  return walk.reasons;
}

std::vector<std::string> validate(const WideTree& tree, std::span<const Triangle> triangles) {
  ValidateWalk walk{tree, {}};
  walk.check_nodes();
  std::vector<bool> valid(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) valid[i] = is_valid(bounds(triangles[i]));
  auto regions = regions_of(walk, valid);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (!valid[i]) continue;
    shrink(regions[i], triangles[i]);
    if (!covered(triangles[i], regions[i])) walk.fail("triangle " + std::to_string(i) + " sticks out of its regions");
  }
  return walk.reasons;
}

} // namespace wavepath::bvh
