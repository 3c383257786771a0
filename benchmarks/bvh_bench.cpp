// How fast trees are built and traversed on the CPU, in primitives and rays per second.
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>
#ifdef WAVEPATH_EMBREE
#include <embree3/rtcore.h>
#endif
#include <tbb/global_control.h>

#include "bvh/build.h"
#include "bvh/measure.h"
#include "bvh/traverse.h"

namespace wavepath::bvh {
namespace {

// Small triangles, anywhere in the unit cube.
std::vector<Triangle> soup(int count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  const float size = 1.0f / std::cbrt(static_cast<float>(count));
  std::vector<Triangle> triangles;
  for (int i = 0; i < count; ++i) {
    const auto point = [&] { return Vec3{uniform(random), uniform(random), uniform(random)}; };
    const Vec3 center = point();
    triangles.push_back({center, center + point() * size, center + point() * size});
  }
  return triangles;
}

// A hilly height field over the unit square, about `count` triangles.
std::vector<Triangle> terrain(int count) {
  const int side = static_cast<int>(std::sqrt(count / 2.0));
  const auto vertex = [side](int i, int j) {
    const float x = static_cast<float>(i) / static_cast<float>(side),
                y = static_cast<float>(j) / static_cast<float>(side);
    return Vec3{x, y, 0.05f * std::sin(20 * x) * std::cos(17 * y) + 0.01f * std::sin(170 * x + 90 * y)};
  };
  std::vector<Triangle> triangles;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  return triangles;
}

std::vector<Triangle> make(int kind, int count) { return kind == 0 ? soup(count) : terrain(count); }

std::vector<Box> boxes_of(const std::vector<Triangle>& triangles) {
  std::vector<Box> boxes;
  for (const Triangle& triangle : triangles) boxes.push_back(bounds(triangle));
  return boxes;
}

// Arguments: kind (0 soup, 1 terrain), triangles, threads, quality (0 fast, 1 balanced, 2 best).
void build_tree(benchmark::State& state) {
  const std::vector<Triangle> triangles = make(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(state.range(2)));
  BuildConfig config;
  config.quality = static_cast<Quality>(state.range(3));
  WideTree tree;
  for (auto _ : state) tree = build(std::span<const Triangle>(triangles), config);
  const Measure measured = measure(tree);
  const auto count = static_cast<double>(triangles.size());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(triangles.size()));
  state.counters["sah"] = measured.sah_cost;
  state.counters["depth"] = tree.depth;
  state.counters["bytes/item"] = static_cast<double>(measured.node_bytes) / count;
  state.counters["copies"] = static_cast<double>(tree.order.size()) / count - 1.0;
  state.counters["children"] = measured.children_per_node;
}
BENCHMARK(build_tree)
    ->ArgNames({"kind", "triangles", "threads", "quality"})
    ->ArgsProduct({{0, 1}, {1'000'000}, {1, 2}, {0, 1, 2}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

#ifdef WAVEPATH_EMBREE
// The same triangles in Embree. Arguments: kind, triangles, threads, quality (0 low: Morton codes, 1 medium: binned
// SAH, 2 high: spatial splits).
void build_embree(benchmark::State& state) {
  const std::vector<Triangle> triangles = make(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  RTCDevice device = rtcNewDevice(state.range(2) == 1 ? "threads=1" : "threads=2");
  RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  std::vector<std::uint32_t> indices(3 * triangles.size());
  std::iota(indices.begin(), indices.end(), 0u);
  rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, triangles.data(), 0, sizeof(Vec3),
                             indices.size());
  rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices.data(), 0, 12, triangles.size());
  rtcCommitGeometry(mesh);
  for (auto _ : state) {
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneBuildQuality(scene, static_cast<RTCBuildQuality>(state.range(3)));
    rtcAttachGeometry(scene, mesh);
    rtcCommitScene(scene);
    rtcReleaseScene(scene);
  }
  rtcReleaseGeometry(mesh);
  rtcReleaseDevice(device);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(triangles.size()));
}
BENCHMARK(build_embree)
    ->ArgNames({"kind", "triangles", "threads", "quality"})
    ->ArgsProduct({{0, 1}, {1'000'000}, {1, 2}, {1, 2}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
#endif

std::vector<Ray> random_rays(int count) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const Vec3 from{uniform(random), uniform(random), 1.5f}, to{uniform(random), uniform(random), 0.0f};
    rays.push_back({from, to - from});
  }
  return rays;
}

// Arguments: kind, triangles, any (0 closest hit, 1 any hit). One thread, incoherent rays from above.
void trace(benchmark::State& state) {
  const std::vector<Triangle> input = make(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const WideTree tree = build(boxes_of(input));
  std::vector<Triangle> triangles;
  for (std::uint32_t index : tree.order) triangles.push_back(input[index]);
  const std::vector<Ray> rays = random_rays(1 << 14);
  Counters counters;
  for (auto _ : state)
    for (const Ray& ray : rays)
      if (state.range(2))
        benchmark::DoNotOptimize(any_hit(tree, triangles, ray, &counters));
      else
        benchmark::DoNotOptimize(closest_hit(tree, triangles, ray, &counters));
  const double total = static_cast<double>(state.iterations()) * static_cast<double>(rays.size());
  state.SetItemsProcessed(static_cast<std::int64_t>(total));
  state.counters["visits"] = static_cast<double>(counters.visits) / total;
  state.counters["tests"] = static_cast<double>(counters.tests) / total;
}
BENCHMARK(trace)->ArgsProduct({{0, 1}, {100'000, 1'000'000}, {0, 1}})->Unit(benchmark::kMillisecond);

} // namespace
} // namespace wavepath::bvh
