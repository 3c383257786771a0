#include "host/bench/work.h"

#include <algorithm>
#include <cstddef>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "kernels/base/frame_types.h"
#include "kernels/base/scene_types.h"
#include "kernels/path/path_types.h"

namespace wavepath {
namespace {

bvh::Vec3 to_bvh(const glm::vec3& v) { return {v.x, v.y, v.z}; }

// One ray through one tree of triangles; true if `any` and something was hit.
bool walk_object(const PackedScene& scene, std::uint32_t root, const bvh::Ray& ray, bool any, float& t_best,
                 bvh::Counters& counters) {
  bvh::PreparedRay prepared = bvh::prepare(ray);
  prepared.t_max = t_best;
  bool found = false;
  bvh::traverse(
      scene.nodes, root, prepared, any ? bvh::Order::largest_first : bvh::Order::nearest_first,
      [&](std::uint32_t first, std::uint32_t count, float& t) {
        for (std::uint32_t item = first; item < first + count; ++item) {
          const gpu::Triangle& triangle = scene.triangles[item];
          bvh::TriangleHit hit;
          if (!bvh::intersect(prepared, {to_bvh(triangle.v0), to_bvh(triangle.v1), to_bvh(triangle.v2)}, hit)) continue;
          if (!(hit.t < t)) continue;
          t = t_best = hit.t;
          found = true;
        }
        return any && found;
      },
      &counters);
  return any && found;
}

bvh::Counters walk(const PackedScene& scene, glm::vec3 origin, glm::vec3 direction, float t_max, bool any) {
  bvh::Counters counters;
  float t_best = t_max;
  const bvh::Ray ray{to_bvh(origin), to_bvh(direction), t_max};
  if (!scene.root_is_top) {
    walk_object(scene, scene.root, ray, any, t_best, counters);
    return counters;
  }
  bvh::Counters top;
  bvh::traverse(
      scene.nodes, scene.root, bvh::prepare(ray), any ? bvh::Order::largest_first : bvh::Order::nearest_first,
      [&](std::uint32_t first, std::uint32_t, float& t) { // one instance a leaf
        const gpu::Instance& instance = scene.instances[first];
        const auto& rows = instance.object_from_world;
        const glm::vec4 o(origin, 1.0f), d(direction, 0.0f);
        const bvh::Ray inside{{glm::dot(rows[0], o), glm::dot(rows[1], o), glm::dot(rows[2], o)},
                              {glm::dot(rows[0], d), glm::dot(rows[1], d), glm::dot(rows[2], d)},
                              t_best};
        const bool stop = walk_object(scene, instance.root, inside, any, t_best, counters);
        t = t_best;
        return stop;
      },
      &top);
  counters.visits += top.visits;
  return counters;
}

struct Sums {
  bvh::Counters own, longest; // of the rays; of their subgroups, for one lane
};

template <class Rays>
RayWork total(const PackedScene& scene, const Rays& rays, bool any, std::uint32_t lanes) {
  tbb::enumerable_thread_specific<Sums> sums;
  tbb::parallel_for(std::size_t{0}, (rays.size() + lanes - 1) / lanes, [&](std::size_t subgroup) {
    Sums& sum = sums.local();
    bvh::Counters longest;
    for (std::size_t i = subgroup * lanes; i < std::min(rays.size(), (subgroup + 1) * lanes); ++i) {
      const bvh::Counters one = walk(scene, rays[i].origin, rays[i].direction, rays[i].t_max, any);
      sum.own.visits += one.visits;
      sum.own.tests += one.tests;
      longest.visits = std::max(longest.visits, one.visits);
      longest.tests = std::max(longest.tests, one.tests);
    }
    sum.longest.visits += longest.visits;
    sum.longest.tests += longest.tests;
  });
  RayWork work;
  std::uint64_t of_a_lane = 0;
  for (const Sums& sum : sums) {
    work.total.visits += sum.own.visits;
    work.total.tests += sum.own.tests;
    of_a_lane += sum.longest.visits + sum.longest.tests;
  }
  if (of_a_lane > 0)
    work.lanes_in_use =
        static_cast<double>(work.total.visits + work.total.tests) / static_cast<double>(of_a_lane * lanes);
  return work;
}

} // namespace

RayWork count_closest(const PackedScene& scene, std::span<const gpu::Ray> rays, std::uint32_t lanes) {
  return total(scene, rays, false, lanes);
}

RayWork count_any(const PackedScene& scene, std::span<const gpu::ShadowRay> rays, std::uint32_t lanes) {
  return total(scene, rays, true, lanes);
}

} // namespace wavepath
