// Tells triangles that have moved from those that have not; see kept_tree.h.
#include "host/scene/pack/kept_tree.h"

#include <algorithm>
#include <vector>

#include "bvh/join.h"

namespace wavepath {
namespace {

// Where less than this part of an object has stayed, one tree over all is as soon built, and is sooner walked.
constexpr double kWorthKeeping = 0.125;

bool is_same(const bvh::Vec3& a, const bvh::Vec3& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

bool is_same(const bvh::Triangle& a, const bvh::Triangle& b) {
  return is_same(a.v0, b.v0) && is_same(a.v1, b.v1) && is_same(a.v2, b.v2);
}

// The tree over some of the triangles.
bvh::WideTree build_over(std::span<const bvh::Triangle> all, std::span<const std::uint32_t> chosen,
                         const bvh::BuildConfig& config, bvh::BuildReport& report) {
  std::vector<bvh::Triangle> triangles;
  std::vector<std::uint8_t> whole;
  triangles.reserve(chosen.size());
  for (const std::uint32_t t : chosen) {
    triangles.push_back(all[t]);
    if (!config.whole.empty()) whole.push_back(config.whole[t]);
  }
  bvh::BuildConfig own = config;
  own.whole = whole;
  return bvh::build(std::span<const bvh::Triangle>(triangles), own, &report);
}

void build_whole(std::span<const bvh::Triangle> triangles, const bvh::BuildConfig& config, KeptTree& kept,
                 std::uint64_t& built) {
  bvh::BuildReport report;
  kept.tree = bvh::build(triangles, config, &report);
  kept.box = report.box;
  built += triangles.size();
}

} // namespace

bvh::WideTree build_again(std::span<const bvh::Triangle> triangles, const bvh::BuildConfig& config, KeptTrees& trees,
                          std::size_t number, bvh::BuildReport& report) {
  if (trees.of_objects.size() <= number) trees.of_objects.resize(number + 1);
  KeptTree& kept = trees.of_objects[number];
  std::uint64_t& built = trees.built;
  const bool is_new = kept.tree.nodes.empty() || kept.triangles.size() != triangles.size() ||
                      !std::ranges::equal(kept.whole, config.whole);
  bool moves = false, others_move = false; // any; and some that had not moved before
  if (is_new) {
    kept = {};
    kept.has_moved.resize(triangles.size());
    kept.whole.assign(config.whole.begin(), config.whole.end());
  } else {
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      if (is_same(triangles[t], kept.triangles[t])) continue;
      moves = true;
      others_move |= !kept.has_moved[t];
      kept.has_moved[t] = 1;
    }
  }
  kept.triangles.assign(triangles.begin(), triangles.end());
  if (is_new || moves) {
    if (others_move) {
      kept.still_ones.clear();
      kept.still = {};
      for (std::uint32_t t = 0; t < triangles.size(); ++t)
        if (!kept.has_moved[t]) kept.still_ones.push_back(t);
    }
    const std::size_t still = kept.still_ones.size();
    if (is_new || static_cast<double>(still) < kWorthKeeping * static_cast<double>(triangles.size())) {
      build_whole(triangles, config, kept, built);
    } else {
      bvh::BuildReport of_still, of_moving;
      if (kept.still.nodes.empty()) {
        kept.still = build_over(triangles, kept.still_ones, config, of_still);
        kept.still_box = of_still.box;
        built += still;
      }
      std::vector<std::uint32_t> moving;
      for (std::uint32_t t = 0; t < triangles.size(); ++t)
        if (kept.has_moved[t]) moving.push_back(t);
      const bvh::WideTree tree = build_over(triangles, moving, config, of_moving);
      built += moving.size();
      kept.box = bvh::merge(kept.still_box, of_moving.box);
      if (std::max(tree.depth, kept.still.depth) < bvh::kMaxDepth)
        kept.tree = bvh::join({kept.still, kept.still_box, kept.still_ones}, {tree, of_moving.box, moving});
      else
        build_whole(triangles, config, kept, built);
    }
  }
  report.box = kept.box;
  return kept.tree;
}

} // namespace wavepath
