// Cases of the tree itself: meshes that drive builders deep or wide, and boxes on a grid at every extent. The builder's
// guarantees are checked on the host, traversal on the device.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "bvh/traverse.h"
#include "bvh/validate.h"
#include "bvh/words.h"
#include "host/selftest/scenes.h"
#include "host/selftest/selftest.h"
#include "host/selftest/shapes.h"
#include "host/selftest/traced_scene.h"

namespace wavepath {
namespace {

constexpr std::array kQualities = {bvh::Quality::fast, bvh::Quality::balanced, bvh::Quality::best};

std::vector<bvh::Triangle> triangles_of(const Positions& positions) {
  const auto convert = [](glm::vec3 v) { return bvh::Vec3{v.x, v.y, v.z}; };
  std::vector<bvh::Triangle> triangles;
  for (std::size_t i = 0; i < positions.size(); i += 3)
    triangles.push_back({convert(positions[i]), convert(positions[i + 1]), convert(positions[i + 2])});
  return triangles;
}

// A ray for every triangle, straight at its middle from a twentieth of its size above.
std::vector<gpu::Ray> rays_at_each(const PackedScene& scene) {
  std::vector<gpu::Ray> rays;
  for (const gpu::Triangle& t : scene.triangles) {
    const glm::dvec3 a(t.v0), b(t.v1), c(t.v2), across = glm::cross(b - a, c - a);
    const glm::dvec3 normal =
        glm::normalize(across / std::max({std::abs(across.x), std::abs(across.y), std::abs(across.z)}));
    const glm::dvec3 origin = (a + b + c) / 3.0 + normal * (0.05 * std::sqrt(glm::length(across)));
    rays.push_back(ray_along(glm::vec3(origin), glm::vec3(-normal)));
  }
  return rays;
}

// Counts the triangles that the ray aimed at them does not hit.
std::uint64_t count_missed(TracedScene& scene) {
  const std::vector<gpu::Hit> hits = scene.closest(rays_at_each(scene.packed()));
  std::uint64_t missed = 0;
  for (std::size_t i = 0; i < hits.size(); ++i)
    missed += hits[i].triangle == gpu::kNone ||
              scene.packed().triangles[hits[i].triangle].id != scene.packed().triangles[i].id;
  return missed;
}

// Triangles at 2^-k, k = 0 .. 120, on both sides of zero: no split halves their number. And a long even line.
Measurement deep_trees(const SelftestContext& context) {
  Positions positions;
  for (const float side : {1.0f, -1.0f})
    for (int k = 0; k <= 120; ++k) {
      const float r = side * std::ldexp(1.0f, -k);
      positions.insert(positions.end(), {{r, 0, 0}, {r * 1.25f, r * 0.25f, 0}, {r * 1.25f, 0, r * 0.25f}});
    }
  std::uint64_t failures = 0, trials = 0;
  std::uint32_t deepest = 0;
  for (const bvh::Quality quality : kQualities) {
    TracedScene scene(context.device, context.kernels, pack_positions(positions, quality));
    deepest = std::max(deepest, scene.packed().stack_size);
    const std::vector<gpu::Hit> hits = scene.closest(rays_at_each(scene.packed()));
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const gpu::Triangle& aim = scene.packed().triangles[i];
      if (std::abs(aim.v0.x) < 0x1p-55f) continue; // its edge functions leave the range of floats: it cannot be hit
      failures += hits[i].triangle == gpu::kNone || scene.packed().triangles[hits[i].triangle].id != aim.id;
      ++trials;
    }
  }
  Positions line;
  for (int i = 0; i < (context.full ? 1'000'000 : 100'000); ++i) {
    const float x = static_cast<float>(i);
    line.insert(line.end(), {{x, 0, 0}, {x + 0.75f, 0.5f, 0}, {x + 0.75f, 0, 0.5f}});
  }
  TracedScene scene(context.device, context.kernels, pack_positions(line));
  deepest = std::max(deepest, scene.packed().stack_size);
  failures += count_missed(scene) + (deepest > bvh::kMaxDepth);
  Measurement result = judge_none(failures, trials + scene.packed().triangles.size(), "triangles not found");
  result.note = fmt::format(
      "deepest tree {} nodes, at most {}, which the traversal's stack is sized for; triangles below "
      "2^-55 are too small for the products of their edges and are not looked for",
      deepest, bvh::kMaxDepth);
  return result;
}

// 100,000 triangles around one centre, each before the next larger as seen from zero.
Measurement equal_centroids(const SelftestContext& context) {
  constexpr int kCount = 100'000;
  const auto radius = [](int i) { return static_cast<float>(std::pow(1.0002, i)); }; // 1 to 5e8
  Positions positions;
  for (int i = 0; i < kCount; ++i) {
    const float r = radius(i); // its plane: x + y + z = -r; its box: [-r, r]^3
    positions.insert(positions.end(), {{r, -r, -r}, {-r, r, -r}, {-r, -r, r}});
  }
  TracedScene scene(context.device, context.kernels, pack_positions(positions));
  scene.use_camera_rays(); // one a lane, as for 10,000 quads in one position
  const double nested = scene.packed().bvh_seconds;
  const double random_ = pack_positions(triangle_soup(kCount, 19, 0.01f)).bvh_seconds;
  Random random(19);
  std::vector<gpu::Ray> rays;
  std::vector<std::uint32_t> expected;
  for (int i = 0; i < 500; ++i) {
    const int between = static_cast<int>(random.below(kCount - 1));
    const glm::vec3 origin(-(radius(between) + radius(between + 1)) / 6.0f);
    for (const int step : {0, 1}) {
      rays.push_back(ray_along(origin, glm::vec3(step ? -1.0f : 1.0f)));
      expected.push_back(static_cast<std::uint32_t>(between + step));
    }
  }
  const std::vector<gpu::Hit> hits = scene.closest(rays, 128);
  std::uint64_t failures = 0;
  for (std::size_t i = 0; i < rays.size(); ++i)
    failures += hits[i].triangle == gpu::kNone || scene.packed().triangles[hits[i].triangle].id != expected[i];
  constexpr std::uint32_t kDepth = 20; // twice log4 of the number of triangles, rounded up
  failures += scene.packed().stack_size > kDepth;
  Measurement result = judge_none(failures, rays.size(), "wrong triangles");
  result.note = fmt::format(
      "depth {}, at most {}, so that building takes n log n; it took {:.1f} times as long as for "
      "random triangles",
      scene.packed().stack_size, kDepth, nested / random_);
  return result;
}

// Every node: the box on its grid holds the exact box, with the margin that the box test needs.
Measurement boxes_hold_their_items(const SelftestContext& context) {
  std::uint64_t failures = 0, nodes = 0, triangles = 0;
  std::string first;
  for (int extent = -6; extent <= 8; extent += 2) {
    const float size = std::pow(10.0f, static_cast<float>(extent));
    const Positions positions = triangle_soup(2000, 20, 0.05f * size, size);
    const std::vector<bvh::Triangle> exact = triangles_of(positions);
    for (const bvh::Quality quality : kQualities) {
      const bvh::WideTree tree = bvh::build(std::span(exact), {.quality = quality});
      const std::vector<std::string> reasons = bvh::validate(tree, std::span(exact));
      if (first.empty() && !reasons.empty()) first = reasons.front();
      failures += reasons.size();
      nodes += tree.nodes.size();
    }
    TracedScene scene(context.device, context.kernels, pack_positions(positions));
    for (const gpu::Hit& hit : scene.closest(rays_at_each(scene.packed()))) failures += hit.triangle == gpu::kNone;
    triangles += scene.packed().triangles.size();
  }
  Measurement result = judge_none(failures, nodes + triangles, "nodes too small or triangles missed");
  result.note =
      fmt::format("{} nodes at extents from 10^-6 to 10^8, checked by the host; {} triangles, found on the device",
                  nodes, triangles);
  if (!first.empty()) result.note += "; " + first;
  return result;
}

// Nodes that rays enter, of those whose boxes are as on the grid and of those whose boxes are as tight as can be.
struct Entries {
  std::uint64_t on_grid = 0, exact = 0;
};

struct EntryCounter {
  const bvh::WideTree& tree;
  std::vector<bvh::Box> exact; // by node

  EntryCounter(const bvh::WideTree& tree_, std::span<const bvh::Triangle> triangles)
      : tree(tree_), exact(tree_.nodes.size()) {
    fill(0, triangles);
  }

  bvh::Box fill(std::uint32_t index, std::span<const bvh::Triangle> triangles) {
    const bvh::WideNode& node = tree.nodes[index];
    bvh::Box box;
    for (std::uint32_t slot = 0; slot < 4; ++slot) {
      if (bvh::is_inner(node, slot)) box = bvh::merge(box, fill(node.first_child + slot, triangles));
      for (std::uint32_t i = 0; i < bvh::item_count(node, slot); ++i)
        box = bvh::merge(box, bvh::bounds(triangles[tree.order[bvh::first_item(node, slot) + i]]));
    }
    return exact[index] = box;
  }

  static bool enters(const glm::dvec3& origin, const glm::dvec3& inverse, const bvh::Box& box) {
    double t_near = 0.0, t_far = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (double{box.lo[axis]} - origin[axis]) * inverse[axis];
      const double b = (double{box.hi[axis]} - origin[axis]) * inverse[axis];
      t_near = std::max(t_near, std::min(a, b)), t_far = std::min(t_far, std::max(a, b));
    }
    return t_near <= t_far;
  }

  void count(std::uint32_t index, const bvh::PreparedRay& ray, const glm::dvec3& origin, const glm::dvec3& inverse,
             Entries& entries) const {
    ++entries.on_grid;
    entries.exact += enters(origin, inverse, exact[index]);
    const bvh::Entered entered = bvh::enter_children(tree.nodes[index], ray, bvh::Ray{}.t_max);
    for (std::uint32_t slot = 0; slot < 4; ++slot)
      if (entered.inner >> slot & 1u) count(tree.nodes[index].first_child + slot, ray, origin, inverse, entries);
  }
};

// A strip of 10^8 x 10^-3 x 10^-3: the grid must not make rays visit nodes that they would not with exact boxes.
Measurement long_strip(const SelftestContext& context) {
  Random random(21);
  Positions positions;
  for (int i = 0; i < 5000; ++i) {
    const glm::vec3 v0(random.uniform(-5e7f, 5e7f), random.uniform(-5e-4f, 5e-4f), random.uniform(-5e-4f, 5e-4f));
    for (const glm::vec3& step :
         {glm::vec3(0), {random.uniform(0, 1e4f), 1e-4f, 0}, {random.uniform(0, 1e4f), 0, 1e-4f}})
      positions.push_back(v0 + step);
  }
  const std::vector<bvh::Triangle> exact = triangles_of(positions);
  const bvh::WideTree tree = bvh::build(std::span(exact), {});
  const std::uint64_t invalid = bvh::validate(tree, std::span(exact)).size();
  const EntryCounter counter(tree, exact);
  Entries entries;
  for (int i = 0; i < 5000; ++i) {
    const glm::vec3 target(random.uniform(-5e7f, 5e7f), random.uniform(-5e-4f, 5e-4f), random.uniform(-5e-4f, 5e-4f));
    const glm::vec3 origin = target + random.direction() * random.log_uniform(-3, 6);
    const glm::dvec3 direction = glm::dvec3(target) - glm::dvec3(origin);
    const bvh::PreparedRay ray =
        bvh::prepare({{origin.x, origin.y, origin.z}, {float(direction.x), float(direction.y), float(direction.z)}});
    counter.count(0, ray, origin, 1.0 / direction, entries);
  }
  TracedScene scene(context.device, context.kernels, pack_positions(positions));
  std::uint64_t missed = 0;
  for (const gpu::Hit& hit : scene.closest(rays_at_each(scene.packed()))) missed += hit.triangle == gpu::kNone;
  const double ratio = static_cast<double>(entries.on_grid) / static_cast<double>(entries.exact);
  Measurement result{"as with exact boxes",
                     fmt::format("{:.3f} times the node visits, {} triangles missed", ratio, missed), "2 times, 0",
                     ratio <= 2.0 && missed + invalid == 0 ? Verdict::pass : Verdict::fail};
  result.note =
      "visits counted on the host, in the same tree with boxes on the grid and with tight ones, without pruning";
  return result;
}

constexpr SelftestCase kTreeCases[] = {
    {18, "trees that grow deep", "rays through very uneven scenes lose objects or crash the driver", deep_trees},
    {19, "100,000 triangles with one centre", "scenes of nested shells take forever to build or show the wrong shell",
     equal_centroids},
    {20, "boxes on the grid hold their triangles", "objects vanish in patches at some scales", boxes_hold_their_items},
    {21, "strip of 10^8 by 10^-3", "long thin scenes render many times slower than they should", long_strip},
};

} // namespace

std::span<const SelftestCase> tree_cases() { return kTreeCases; }

} // namespace wavepath
