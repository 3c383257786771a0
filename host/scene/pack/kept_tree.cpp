// Tells triangles that have moved from those that have not; see kept_tree.h.
#include "host/scene/pack/kept_tree.h"

#include <algorithm>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "bvh/join.h"
#include "bvh/measure.h"
#include "bvh/prune.h"

namespace wavepath {
namespace {

// Where less than this part of an object has stayed, one tree over all is as soon built, and is sooner walked.
constexpr double kWorthKeeping = 0.125;
// Where more than this part has moved, but rests when others begin to move, one tree over all is built anew.
constexpr double kMostResting = 0.125;

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
  kept.sah_cost = bvh::measure(kept.tree).sah_cost;
  kept.is_joined = false;
  kept.still = {};
  kept.has_moved.assign(triangles.size(), 0);
  built += triangles.size();
}

// A walk that enters the root of both goes on to each of them as often as their areas say.
double joined_cost(const KeptTree& kept, const bvh::Box& of_moving, double moving_cost) {
  const double whole = half_area(kept.box);
  if (!(whole > 0.0)) return 0.0;
  return 1.0 + (half_area(kept.still_box) * kept.still_cost + half_area(of_moving) * moving_cost) / whole;
}

// Of the triangles that have not moved, to the bit as a build finds it.
bvh::Box still_box(const KeptTree& kept) {
  const auto add = [&](const tbb::blocked_range<std::size_t>& range, bvh::Box box) {
    for (std::size_t t = range.begin(); t < range.end(); ++t) {
      if (kept.has_moved[t]) continue;
      const bvh::Box one = bounds(kept.triangles[t]);
      if (is_valid(one)) box = merge(box, one);
    }
    return box;
  };
  const auto both = [](const bvh::Box& a, const bvh::Box& b) { return merge(a, b); };
  return tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, kept.triangles.size()), bvh::Box{}, add, both);
}

// Builds the trees over kept.triangles that kept.has_moved asks for. `moves`: how many are elsewhere; `others_move`:
// some of them had not moved before. Returns what move_again() does.
bool build_moved(const bvh::BuildConfig& config, std::size_t moves, bool others_move, KeptTree& kept,
                 std::uint64_t& built) {
  const std::span<const bvh::Triangle> triangles = kept.triangles;
  const auto part = [&](double fraction) { return fraction * static_cast<double>(triangles.size()); };
  const auto moved = static_cast<std::size_t>(std::ranges::count(kept.has_moved, std::uint8_t{1}));
  const bool rest = others_move && static_cast<double>(moved - moves) > part(kMostResting);
  kept.former = {};
  if (static_cast<double>(triangles.size() - moved) < part(kWorthKeeping) || rest) {
    kept.former = std::move(kept.tree.order);
    build_whole(triangles, config, kept, built);
    return false;
  }
  const bool goes_on = kept.is_joined && !others_move;
  if (others_move) {
    kept.still = bvh::prune(kept.still.nodes.empty() ? kept.tree : kept.still, kept.has_moved);
    kept.still_box = still_box(kept);
    kept.still_cost = bvh::measure(kept.still).sah_cost;
  }
  std::vector<std::uint32_t> moving;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    if (kept.has_moved[t]) moving.push_back(t);
  bvh::BuildReport of_moving;
  const bvh::WideTree tree = build_over(triangles, moving, config, of_moving);
  built += moving.size();
  const bool is_empty = tree.order.empty() || kept.still.order.empty(); // beyond the largest coordinates
  if (is_empty || std::max(tree.depth, kept.still.depth) >= bvh::kMaxDepth) {
    kept.former = std::move(kept.tree.order);
    build_whole(triangles, config, kept, built);
    return false;
  }
  kept.box = bvh::merge(kept.still_box, of_moving.box);
  kept.sah_cost = joined_cost(kept, of_moving.box, bvh::measure(tree).sah_cost);
  const bvh::JoinedTree first{kept.still, kept.still_box, {}}, second{tree, of_moving.box, moving};
  if (goes_on) {
    bvh::join_again(first, second, kept.tree);
  } else {
    kept.former = std::move(kept.tree.order);
    kept.tree = bvh::join(first, second);
  }
  kept.is_joined = true;
  return goes_on;
}

// Returns whether it is elsewhere. `others_move` becomes true if it had not moved before.
bool note_move(const bvh::Triangle& now, std::size_t t, KeptTree& kept, bool& others_move) {
  if (is_same(now, kept.triangles[t])) return false;
  kept.triangles[t] = now;
  others_move |= !kept.has_moved[t];
  kept.has_moved[t] = 1;
  return true;
}

} // namespace

const KeptTree& build_again(std::span<const bvh::Triangle> triangles, const bvh::BuildConfig& config, KeptTrees& trees,
                            std::size_t number) {
  if (trees.of_objects.size() <= number) trees.of_objects.resize(number + 1);
  KeptTree& kept = trees.of_objects[number];
  const bool is_new = kept.tree.nodes.empty() || kept.triangles.size() != triangles.size() ||
                      !std::ranges::equal(kept.whole, config.whole);
  if (is_new) {
    kept = {};
    kept.whole.assign(config.whole.begin(), config.whole.end());
    kept.triangles.assign(triangles.begin(), triangles.end());
    build_whole(triangles, config, kept, trees.built);
    return kept;
  }
  std::size_t moves = 0;
  bool others_move = false;
  for (std::size_t t = 0; t < triangles.size(); ++t) moves += note_move(triangles[t], t, kept, others_move);
  if (moves > 0) build_moved(config, moves, others_move, kept, trees.built);
  return kept;
}

bool move_again(std::span<const MovedTriangles> moved, bvh::Quality quality, KeptTree& kept, std::uint64_t& built) {
  std::size_t moves = 0;
  bool others_move = false;
  for (const MovedTriangles& some : moved)
    for (std::size_t i = 0; i < some.triangles.size(); ++i)
      moves += note_move(some.triangles[i], some.first + i, kept, others_move);
  if (moves == 0) {
    kept.former = {};
    return kept.is_joined;
  }
  return build_moved({.quality = quality, .whole = kept.whole}, moves, others_move, kept, built);
}

} // namespace wavepath
