// Each kernel of the wavefront alone: what it writes for a known input, against the CPU reference or by hand.
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>

#include "bvh/traverse.h"
#include "host/film/exact_sum.h"
#include "host/render/workspace/device_scene.h"
#include "kernels/base/division.h"
#include "kernels/base/features.h"
#include "kernels/base/frame_types.h"
#include "kernels/base/light_tree_types.h"
#include "kernels/base/scene_types.h"
#include "kernels/base/tile_order.h"
#include "kernels/film/film_types.h"
#include "kernels/path/accumulate.spv.h"
#include "kernels/path/advance.spv.h"
#include "kernels/path/connect.spv.h"
#include "kernels/path/extend.spv.h"
#include "kernels/path/generate.spv.h"
#include "kernels/path/path_types.h"
#include "tests/probe.h"

namespace wavepath::test {
namespace {

constexpr std::uint32_t kSlots = 1 << 14;

// All bindings of the path tracer, with memory that a test can fill and read.
struct Bench {
  Bench(Device& device_, const PackedScene& packed, gpu::Feature features, const gpu::Frame& frame_,
        std::uint32_t walk = gpu::kWalkInStep)
      : device(device_),
        scene(upload_scene(device_, packed)),
        frame(device_, sizeof(gpu::Frame)),
        paths(device_, kSlots * sizeof(gpu::PathState)),
        media(device_, kSlots * 4),
        path_aovs(device_, kSlots * sizeof(gpu::PathAovs)),
        rays(device_, 2 * kSlots * sizeof(gpu::Ray)),
        hits(device_, kSlots * sizeof(gpu::Hit)),
        sorted_rays(device_, kSlots * 4),
        shadow_rays(device_, kSlots * sizeof(gpu::ShadowRay)),
        queues(device_, sizeof(gpu::Queues)),
        counters(device_, sizeof(gpu::Counters)),
        film(device_, kSlots * gpu::kReplicates * sizeof(gpu::FilmPixel)),
        film_aovs(device_, kSlots * sizeof(gpu::FilmAovs)),
        places(device_, kSlots * 4),
        receivers(device_, kSlots * 16),
        light_sums(device_, 16),
        constants{static_cast<std::uint32_t>(features),
                  packed.stack_size + 2,
                  gpu::kSamplerSobol,
                  gpu::kDirectMis,
                  gpu::kHemisphereCosine,
                  gpu::kFilterBox,
                  walk,
                  gpu::kProbingOff,
                  static_cast<std::uint32_t>(features >> 32)} {
    constants[gpu::kSpecLaneRays] = 2;
    frame.write(&frame_, sizeof(frame_));
    for (Buffer* buffer : {&paths, &media, &path_aovs, &film, &film_aovs}) buffer->fill_zero();
    set_queues({});
    set_counters({});
    using enum BindingKind;
    std::vector<Binding> all = scene.bindings();
    all.insert(all.end(), {{gpu::kBindFrame, uniform, &frame},
                           {gpu::kBindPaths, storage, &paths},
                           {gpu::kBindPathTexels, texels_rgba32f, &paths},
                           {gpu::kBindRays, storage, &rays},
                           {gpu::kBindRayTexels, texels_rgba32f, &rays},
                           {gpu::kBindHits, storage, &hits},
                           {gpu::kBindHitTexels, texels_rgba32ui, &hits},
                           {gpu::kBindSortedRays, storage, &sorted_rays},
                           {gpu::kBindSortedRayTexels, texels_r32ui, &sorted_rays},
                           {gpu::kBindShadowRays, storage, &shadow_rays},
                           {gpu::kBindShadowRayTexels, texels_rgba32ui, &shadow_rays},
                           {gpu::kBindQueues, storage, &queues},
                           {gpu::kBindFilm, storage, &film},
                           {gpu::kBindFilmTexels, texels_rgba32ui, &film},
                           {gpu::kBindPathMedia, storage, &media},
                           {gpu::kBindPathAovs, storage, &path_aovs},
                           {gpu::kBindFilmAovs, storage, &film_aovs},
                           {gpu::kBindEntries, texels_r32ui, &places},
                           {gpu::kBindCounters, storage, &counters},
                           {gpu::kBindSeen, storage, &film},
                           {gpu::kBindReceivers, storage, &receivers},
                           {gpu::kBindReceiverTexels, texels_rgba32ui, &receivers},
                           {gpu::kBindLightSums, storage, &light_sums}});
    bindings = std::make_unique<BindingSet>(device, all, static_cast<std::uint32_t>(sizeof(gpu::Wave)));
  }

  void set_queues(gpu::Queues value) { queues.write(&value, sizeof(value)); }
  void set_counters(gpu::Counters value) { counters.write(&value, sizeof(value)); }
  gpu::Counters get_counters() const { return download<gpu::Counters>(counters, 1).front(); }
  gpu::Queues get_queues() const { return download<gpu::Queues>(queues, 1).front(); }

  void run(std::span<const std::uint32_t> spirv, std::uint32_t groups, const gpu::Wave& wave) {
    const Kernel kernel(device, "kernel", spirv, *bindings, constants);
    Commands commands(device);
    commands.bind(*bindings);
    commands.dispatch(kernel, groups, &wave);
    commands.submit_and_wait();
  }

  Device& device;
  DeviceScene scene;
  Buffer frame, paths, media, path_aovs, rays, hits, sorted_rays, shadow_rays, queues, counters, film, film_aovs,
      places, receivers, light_sums;
  std::array<std::uint32_t, gpu::kSpecCount> constants;
  std::unique_ptr<BindingSet> bindings;
};

gpu::Frame frame_of(const PackedScene& packed, std::uint32_t width = 64, std::uint32_t height = 64) {
  gpu::Frame frame{};
  frame.root = packed.root;
  frame.root_is_top = packed.root_is_top;
  frame.scene_features = static_cast<std::uint32_t>(packed.features);
  frame.scene_lobes = static_cast<std::uint32_t>(packed.features >> 32);
  frame.first_layers = static_cast<std::uint32_t>(packed.materials.size() * gpu::kMaterialTexels);
  frame.slot_count = kSlots;
  frame.width = frame.film_width = width;
  frame.height = frame.film_height = height;
  frame.sample_total = 16;
  frame.camera_forward = {0, 0, -1};
  frame.camera_right = {2, 0, 0};
  frame.camera_up = {0, 1, 0};
  frame.camera_position = {1, 2, 3};
  return frame;
}

// `count` random triangles of very different sizes around the origin, as one mesh; single-sided ones every third.
Scene soup(std::uint32_t count, std::uint32_t seed, bool double_sided) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  Scene scene;
  scene.materials.emplace_back().double_sided = double_sided;
  Mesh& mesh = scene.meshes.emplace_back();
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::vec3 centre = glm::vec3(unit(random), unit(random), unit(random)) * 10.0f;
    const float size = std::pow(10.0f, unit(random));
    for (std::uint32_t v = 0; v < 3; ++v) {
      mesh.positions.push_back(centre + size * glm::vec3(unit(random), unit(random), unit(random)));
      mesh.indices.push_back(3 * i + v);
    }
  }
  mesh.primitives.push_back({0, 3 * count, 0, false});
  scene.instances.push_back({0, glm::dmat4(1.0)});
  return scene;
}

std::vector<gpu::Ray> random_rays(std::uint32_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  std::vector<gpu::Ray> rays;
  for (std::uint32_t i = 0; i < count; ++i) {
    glm::vec3 d(unit(random), unit(random), unit(random));
    if (i % 16 == 0) d = glm::vec3(0.0f, i % 32 ? -0.0f : 0.0f, i % 64 ? 1.0f : -1.0f); // along an axis
    rays.push_back(
        {glm::vec3(unit(random), unit(random), unit(random)) * 15.0f, i, glm::normalize(d), i % 5 ? gpu::kFar : 8.0f});
  }
  rays[1].origin.x = std::numeric_limits<float>::quiet_NaN();
  rays[2].direction.y = std::numeric_limits<float>::infinity();
  return rays;
}

bvh::Vec3 to_bvh(glm::vec3 v) { return {v.x, v.y, v.z}; }

std::vector<bvh::Triangle> triangles_of(const PackedScene& packed) {
  std::vector<bvh::Triangle> triangles;
  for (const gpu::Triangle& t : packed.triangles) triangles.push_back({to_bvh(t.v0), to_bvh(t.v1), to_bvh(t.v2)});
  return triangles;
}

bvh::WideTree tree_of(const PackedScene& packed) {
  bvh::WideTree tree{packed.nodes, {}, packed.stack_size};
  for (const gpu::Triangle& t : packed.triangles) tree.order.push_back(t.id);
  return tree;
}

// How lanes get their rays: where they walk by themselves, those of a bounce are taken from the queue by lanes that are
// done. Rays of bounce 2 lie in the same queue as the camera's.
struct Way {
  std::uint32_t walk, bounce;
};
constexpr Way kWays[] = {{gpu::kWalkInStep, 0}, {gpu::kWalkByLane, 0}, {gpu::kWalkByLane, 2}};

class Kernels : public VulkanTest {};

TEST_F(Kernels, ExtendEqualsReference) {
  Scene scene = soup(3000, 1, true);
  const PackedScene packed = pack(scene);
  const auto rays = random_rays(kSlots, 2);
  const auto triangles = triangles_of(packed);
  const bvh::WideTree tree = tree_of(packed);
  const gpu::Feature all = gpu::kFeaturesAll & ~gpu::kFeatureAovs & ~gpu::kFeatureAdaptive;
  constexpr std::uint32_t kRays = kSlots - 37; // the last group is not full
  for (std::size_t run = 0; run < 2 * std::size(kWays); ++run) {
    const Way way = kWays[run / 2];
    Bench bench(device(), packed, run % 2 ? all : packed.features, frame_of(packed), way.walk);
    bench.rays.write(rays.data(), rays.size() * sizeof(gpu::Ray));
    bench.set_queues({.ray_count = {kRays, 0}});
    bench.run(wavepath_extend_spv, kSlots / gpu::kWorkgroupSize, {0, 4096, 0, 4, way.bounce, 0});
    const auto hits = download<gpu::Hit>(bench.hits, kSlots);
    std::uint32_t found = 0;
    for (std::uint32_t i = 0; i < kRays; ++i) {
      const bvh::Hit expected =
          bvh::closest_hit(tree, triangles, {to_bvh(rays[i].origin), to_bvh(rays[i].direction), rays[i].t_max});
      ASSERT_EQ(hits[i].triangle, expected.item) << "ray " << i;
      if (expected.item == bvh::kAbsent) continue;
      ++found;
      if (device().info().type != "cpu") continue; // other devices may divide within 2.5 ulp
      ASSERT_EQ(hits[i].b1, expected.triangle.b1) << "ray " << i;
      ASSERT_EQ(hits[i].b2, expected.triangle.b2) << "ray " << i;
    }
    EXPECT_GT(found, kSlots / 4);
    EXPECT_LT(found, kSlots);
  }
}

TEST_F(Kernels, ExtendCullsTheBacksOfSingleSidedTriangles) {
  Scene scene = soup(1, 1, false);
  scene.meshes[0].positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}; // counter-clockwise from +z
  const PackedScene packed = pack(scene);
  const glm::vec3 target = glm::vec3(0.25f, 0.25f, 0.0f) - glm::vec3(packed.origin);
  Bench bench(device(), packed, packed.features, frame_of(packed));
  const std::vector<gpu::Ray> rays = {{target + glm::vec3(0, 0, 1), 0, {0, 0, -1}, gpu::kFar},
                                      {target - glm::vec3(0, 0, 1), 1, {0, 0, 1}, gpu::kFar}};
  bench.rays.write(rays.data(), rays.size() * sizeof(gpu::Ray));
  bench.set_queues({.ray_count = {2, 0}});
  bench.run(wavepath_extend_spv, 1, {0, 4096, 0, 4, 0, 0});
  const auto hits = download<gpu::Hit>(bench.hits, 2);
  EXPECT_EQ(hits[0].triangle, 0u);
  EXPECT_EQ(hits[1].triangle, gpu::kNone);
}

// Many instances of one mesh under mirrored, scaled and rotated transforms, against every triangle of every instance.
TEST_F(Kernels, ExtendEqualsBruteForceOverInstances) {
  Scene scene = soup(200, 3, true);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  scene.instances.clear();
  for (int i = 0; i < 24; ++i) {
    glm::dmat4 m(1.0);
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) m[c][r] = 0.15 * unit(random) + (c == r ? (i % 2 ? -0.5 : 0.5) : 0.0);
    m[3] = glm::dvec4(8 * unit(random), 8 * unit(random), 8 * unit(random), 1.0);
    scene.instances.push_back({0, m});
  }
  const PackedScene packed = pack(scene);
  ASSERT_TRUE(packed.root_is_top);
  const auto rays = random_rays(4096, 5);
  std::vector<gpu::Hit> hits;
  for (const auto& [walk, bounce] : kWays) {
    Bench bench(device(), packed, packed.features, frame_of(packed), walk);
    bench.rays.write(rays.data(), rays.size() * sizeof(gpu::Ray));
    bench.set_queues({.ray_count = {4096, 0}});
    bench.run(wavepath_extend_spv, 64, {0, 4096, 0, 4, bounce, 0});
    const auto found = download<gpu::Hit>(bench.hits, 4096);
    for (std::uint32_t i = 0; i < hits.size(); ++i) {
      ASSERT_EQ(found[i].triangle, hits[i].triangle) << "ray " << i;
      ASSERT_EQ(found[i].instance, hits[i].instance) << "ray " << i;
    }
    hits = found;
  }

  std::uint32_t found = 0, different = 0;
  for (std::uint32_t i = 0; i < 4096; ++i) {
    float best = rays[i].t_max;
    gpu::Hit expected{gpu::kNone, 0, 0, 0};
    for (std::uint32_t k = 0; k < packed.instances.size(); ++k) {
      const auto& rows = packed.instances[k].object_from_world;
      const glm::vec4 o(rays[i].origin, 1.0f), d(rays[i].direction, 0.0f);
      const bvh::Ray ray{{glm::dot(rows[0], o), glm::dot(rows[1], o), glm::dot(rows[2], o)},
                         {glm::dot(rows[0], d), glm::dot(rows[1], d), glm::dot(rows[2], d)},
                         best};
      const bvh::PreparedRay prepared = bvh::prepare(ray);
      if (!prepared.valid) continue;
      for (std::uint32_t t = 0; t < packed.triangles.size(); ++t) {
        bvh::TriangleHit hit;
        const gpu::Triangle& triangle = packed.triangles[t];
        if (bvh::intersect(prepared, {to_bvh(triangle.v0), to_bvh(triangle.v1), to_bvh(triangle.v2)}, hit) &&
            hit.t < best) {
          best = hit.t;
          expected = {t, k, hit.b1, hit.b2};
        }
      }
    }
    found += expected.triangle != gpu::kNone;
    different += hits[i].triangle != expected.triangle ||
                 (expected.triangle != gpu::kNone && hits[i].instance != expected.instance);
  }
  EXPECT_GT(found, 400u);
  EXPECT_LE(different, 2u); // transforms may round differently in the last bit: rays through an edge
}

TEST_F(Kernels, ConnectAddsLightWhereNothingIsInBetween) {
  Scene scene = soup(3000, 6, true);
  PackedScene packed = pack(scene);
  packed.lights = {gpu::Light{.kind = gpu::kLightPoint}};
  const auto triangles = triangles_of(packed);
  const bvh::WideTree tree = tree_of(packed);
  auto rays = random_rays(kSlots, 7);
  std::vector<gpu::ShadowRay> shadow_rays;
  for (gpu::Ray& ray : rays)
    shadow_rays.push_back({ray.origin, ray.slot, ray.direction * 12.0f, ray.slot % 2 ? 1.0f : gpu::kFar, {1, 2, 3}, 0});
  for (const std::uint32_t walk : {gpu::kWalkByLane, gpu::kWalkInStep}) {
    Bench bench(device(), packed, packed.features, frame_of(packed), walk);
    bench.shadow_rays.write(shadow_rays.data(), shadow_rays.size() * sizeof(gpu::ShadowRay));
    bench.set_queues({.shadow_count = {kSlots}});
    bench.run(wavepath_connect_spv, kSlots / gpu::kWorkgroupSize, {0, 4096, 0, 4, 0, 0});
    const auto paths = download<gpu::PathState>(bench.paths, kSlots);
    std::uint32_t blocked_count = 0;
    for (std::uint32_t i = 0; i < kSlots; ++i) {
      const gpu::ShadowRay& ray = shadow_rays[i];
      const bool blocked = bvh::any_hit(tree, triangles, {to_bvh(ray.origin), to_bvh(ray.direction), ray.t_max});
      blocked_count += blocked;
      ASSERT_EQ(paths[i].radiance, blocked ? glm::vec3(0.0f) : glm::vec3(1, 2, 3)) << "ray " << i;
    }
    EXPECT_GT(blocked_count, kSlots / 8);
    EXPECT_LT(blocked_count, kSlots);
  }
}

// A light must not hide itself, however the ray towards it rounds; what it hides from others stays hidden.
TEST_F(Kernels, ConnectIsNotBlockedByTheTriangleThatItAimsAt) {
  Scene scene = soup(1, 1, true);
  PackedScene packed = pack(scene);
  packed.features |= gpu::kFeatureTriangleLights;
  packed.triangles[0].id = 5;
  packed.lights = {gpu::Light{.kind = gpu::kLightTriangle, .triangle_id = 5},
                   gpu::Light{.kind = gpu::kLightTriangle, .triangle_id = 1},
                   gpu::Light{.kind = gpu::kLightPoint, .triangle_id = 5}};
  const gpu::Triangle& triangle = packed.triangles[0];
  const glm::vec3 centre = (triangle.v0 + triangle.v1 + triangle.v2) / 3.0f;
  const glm::vec3 normal = glm::normalize(glm::cross(triangle.v1 - triangle.v0, triangle.v2 - triangle.v0));
  std::vector<gpu::ShadowRay> shadow_rays;
  for (std::uint32_t i = 0; i < 3; ++i) shadow_rays.push_back({centre + normal, i, -normal, 2.0f, {1, 2, 3}, i});
  Bench bench(device(), packed, packed.features, frame_of(packed));
  bench.shadow_rays.write(shadow_rays.data(), shadow_rays.size() * sizeof(gpu::ShadowRay));
  bench.set_queues({.shadow_count = {3}});
  bench.run(wavepath_connect_spv, 1, {0, 4096, 0, 4, 0, 0});
  const auto paths = download<gpu::PathState>(bench.paths, 3);
  EXPECT_EQ(paths[0].radiance.x, 1.0f);
  EXPECT_EQ(paths[1].radiance.x, 0.0f);
  EXPECT_EQ(paths[2].radiance.x, 0.0f);
}

// Every second triangle is a hole: rays must find what they would find without it, whatever order they meet them in.
TEST_F(Kernels, HolesAreInvisibleToExtendAndConnect) {
  Scene scene = soup(3000, 8, true);
  scene.materials[0].alpha_mode = AlphaMode::mask;
  for (std::uint32_t v = 0; v < 9000; ++v) // part of every triangle is hole: what is all hole leaves the tree
    scene.meshes[0].colors.emplace_back(1.0f, 1.0f, 1.0f, v % 3 == v / 3 % 3 ? 1.0f : 0.0f);
  PackedScene packed = pack(scene);
  packed.lights = {gpu::Light{.kind = gpu::kLightPoint}};
  ASSERT_TRUE(packed.features & gpu::kFeatureAlpha);
  const auto triangles = triangles_of(packed);
  const bvh::WideTree tree = tree_of(packed);
  const auto is_hole = [&](const bvh::Hit& hit) {
    const auto alpha = [&](int corner) { return packed.vertex_colors[packed.triangle_vertices[hit.item][corner]].a; };
    const float b1 = hit.triangle.b1, b2 = hit.triangle.b2;
    return (1.0f - b1 - b2) * alpha(0) + b1 * alpha(1) + b2 * alpha(2) < packed.materials[0].alpha_cutoff;
  };
  const auto expected_hit = [&](const bvh::Ray& ray) {
    const bvh::PreparedRay prepared = bvh::prepare(ray);
    bvh::Hit best;
    bvh::traverse(packed.nodes, packed.root, prepared, bvh::Order::nearest_first,
                  [&](std::uint32_t first, std::uint32_t count, float& t_best) {
                    for (std::uint32_t item = first; item < first + count; ++item) {
                      bvh::Hit found = best;
                      float t = t_best;
                      bvh::test_leaf(prepared, triangles, tree.order, item, 1, t, found);
                      if (found.item != item || is_hole(found)) continue;
                      best = found;
                      t_best = t;
                    }
                    return false;
                  });
    return best.item;
  };

  const auto rays = random_rays(kSlots, 9);
  std::vector<gpu::ShadowRay> shadow_rays;
  for (const gpu::Ray& ray : rays)
    shadow_rays.push_back({ray.origin, ray.slot, ray.direction, ray.t_max, {1, 2, 3}, 0});
  for (const auto& [walk, bounce] : kWays) { // alpha waits in the first one
    Bench bench(device(), packed, packed.features, frame_of(packed));
    bench.constants[gpu::kSpecWalk] = walk;
    bench.rays.write(rays.data(), rays.size() * sizeof(gpu::Ray));
    bench.shadow_rays.write(shadow_rays.data(), shadow_rays.size() * sizeof(gpu::ShadowRay));
    bench.set_queues({.ray_count = {kSlots, 0}, .shadow_count = {kSlots}});
    bench.run(wavepath_extend_spv, kSlots / gpu::kWorkgroupSize, {0, 4096, 0, 4, bounce, 0});
    bench.run(wavepath_connect_spv, kSlots / gpu::kWorkgroupSize, {0, 4096, 0, 4, 0, 0});
    const auto hits = download<gpu::Hit>(bench.hits, kSlots);
    const auto paths = download<gpu::PathState>(bench.paths, kSlots);
    std::uint32_t found = 0;
    for (std::uint32_t i = 0; i < kSlots; ++i) {
      const std::uint32_t expected = expected_hit({to_bvh(rays[i].origin), to_bvh(rays[i].direction), rays[i].t_max});
      found += expected != bvh::kAbsent;
      ASSERT_EQ(hits[i].triangle, expected) << "ray " << i;
      ASSERT_EQ(paths[i].radiance.x, expected == bvh::kAbsent ? 1.0f : 0.0f) << "ray " << i;
    }
    EXPECT_GT(found, kSlots / 4);
    EXPECT_LT(found, kSlots);
  }
}

// Every ray is in one of the two queues, once: with what it found from the front, with what escaped from the back.
TEST_F(Kernels, ExtendSortsHitsAndEscapes) {
  Scene scene = soup(60, 3, true);
  const PackedScene packed = pack(scene);
  constexpr std::uint32_t kRays = kSlots - 37; // the last group is not full
  const auto rays = random_rays(kRays, 4);
  for (std::size_t run = 0; run < 2 * std::size(kWays); ++run) {
    const auto [walk, bounce] = kWays[run / 2];
    const std::uint32_t sort = run % 2 ? gpu::kSortEscapes : gpu::kSortHits;
    Bench bench(device(), packed, packed.features, frame_of(packed), walk);
    bench.constants[gpu::kSpecSort] = sort;
    const std::vector<std::uint32_t> untouched(kSlots, gpu::kNone);
    bench.sorted_rays.write(untouched.data(), kSlots * 4);
    bench.rays.write(rays.data(), rays.size() * sizeof(gpu::Ray));
    bench.set_queues({.ray_count = {kRays, 0}});
    bench.run(wavepath_extend_spv, kSlots / gpu::kWorkgroupSize, {0, 4096, 0, 4, bounce, 0});
    const auto hits = download<gpu::Hit>(bench.hits, kSlots);
    const auto sorted = download<std::uint32_t>(bench.sorted_rays, kSlots);
    const gpu::Queues queues = bench.get_queues();
    const bool escapes = sort == gpu::kSortEscapes;
    ASSERT_GT(queues.hit_count, kRays / 20);
    ASSERT_LT(queues.hit_count, kRays - kRays / 20);
    EXPECT_EQ(queues.escape_count, escapes ? kRays - queues.hit_count : 0u);
    std::vector<int> seen(kRays, 0);
    const auto expect_found = [&](std::uint32_t place, bool hit) {
      ASSERT_LT(sorted[place], kRays);
      EXPECT_EQ(hits[sorted[place]].triangle != gpu::kNone, hit);
      EXPECT_EQ(++seen[sorted[place]], 1);
    };
    for (std::uint32_t i = 0; i < queues.hit_count; ++i) expect_found(i, true);
    for (std::uint32_t i = 0; i < queues.escape_count; ++i) expect_found(kSlots - 1 - i, false);
    for (std::uint32_t i = 0; i < kRays; ++i) EXPECT_EQ(seen[i], escapes || hits[i].triangle != gpu::kNone ? 1 : 0);
  }
}

TEST_F(Kernels, GenerateCoversEveryPixelOnce) {
  Scene scene = soup(1, 1, true);
  const PackedScene packed = pack(scene);
  const std::uint32_t width = 37, height = 21, count = width * height;
  const gpu::Frame frame = frame_of(packed, width, height);
  Bench bench(device(), packed, packed.features, frame);
  bench.run(wavepath_generate_spv, (2 * count + 63) / 64, {0, count, 5, 2, 0, 0});
  EXPECT_EQ(bench.get_queues().ray_count[0], 2 * count);
  const auto rays = download<gpu::Ray>(bench.rays, 2 * count);
  std::vector<int> seen(count, 0);
  for (std::uint32_t slot = 0; slot < 2 * count; ++slot) {
    ASSERT_EQ(rays[slot].slot, slot);
    ASSERT_EQ(rays[slot].origin, frame.camera_position);
    const glm::vec3 d = rays[slot].direction / -rays[slot].direction.z;
    const double x = (d.x / 2.0 + 1.0) / 2.0 * width,
                 y = (1.0 - d.y) / 2.0 * height; // the box filter stays in the pixel
    const glm::uvec2 pixel = gpu::pixel_in_tile_order(slot % count, width, height);
    ASSERT_NEAR(x, pixel.x + 0.5, 0.5 + 1e-4);
    ASSERT_NEAR(y, pixel.y + 0.5, 0.5 + 1e-4);
    ++seen[pixel.y * width + pixel.x];
  }
  for (const int times : seen) EXPECT_EQ(times, 2);
}

TEST_F(Kernels, AdvanceCountsRaysBeyond32Bits) {
  Scene scene = soup(1, 1, true);
  const PackedScene packed = pack(scene);
  Bench bench(device(), packed, packed.features, frame_of(packed));
  bench.set_queues({.ray_count = {1000, 77},
                    .hit_count = 7,
                    .escape_count = 9,
                    .next_ray = 5,
                    .next_shadow_ray = 6,
                    .shadow_count = {65}});
  bench.set_counters({.camera_rays = {0xfffffff0u, 3}});
  bench.run(wavepath_advance_spv, 1, {0, 0, 0, 0, gpu::kBeforeExtend, 0}); // of bounce 0
  gpu::Queues queues = bench.get_queues();
  EXPECT_EQ(queues.extend_groups[0], 16u);
  EXPECT_EQ(queues.ray_count[0], 1000u);
  EXPECT_EQ(queues.ray_count[1], 0u);
  EXPECT_EQ(queues.shadow_count[0], 0u);
  EXPECT_EQ(queues.hit_count, 0u);
  EXPECT_EQ(queues.escape_count, 0u);
  EXPECT_EQ(queues.next_ray, 0u);
  EXPECT_EQ(queues.next_shadow_ray, 6u);
  EXPECT_EQ(bench.get_counters().camera_rays[0], 1000u - 16u);
  EXPECT_EQ(bench.get_counters().camera_rays[1], 4u);
  queues.hit_count = 129;
  queues.escape_count = 0;
  queues.shadow_count[0] = 7; // of the bounce before
  bench.set_queues(queues);
  bench.run(wavepath_advance_spv, 1, {0, 0, 0, 0, gpu::kBeforeShade, 0});
  queues = bench.get_queues();
  EXPECT_EQ(queues.shade_groups[0], 3u);
  EXPECT_EQ(queues.shade_groups[1], 1u);
  EXPECT_EQ(queues.escape_groups[0], 0u);
  EXPECT_EQ(queues.shadow_count[0], 0u);
  queues.shadow_count[0] = 65;
  bench.set_queues(queues);
  bench.run(wavepath_advance_spv, 1, {0, 0, 0, 0, gpu::kBeforeConnect, 0});
  queues = bench.get_queues();
  EXPECT_EQ(queues.connect_groups[0], 2u);
  EXPECT_EQ(queues.next_shadow_ray, 0u);
  EXPECT_EQ(queues.extend_groups[0], 16u); // as it was
  EXPECT_EQ(bench.get_counters().shadow_rays[0], 65u);
  EXPECT_EQ(bench.get_counters().camera_rays[1], 4u);

  // The last light sample of a bounce prepares extend of the next one as well, while its own rays wait for connect.
  queues.ray_count[1] = 300;
  queues.next_ray = 5;
  bench.set_queues(queues);
  bench.run(wavepath_advance_spv, 1, {0, 0, 0, 0, gpu::kBeforeLastConnect, 0});
  queues = bench.get_queues();
  EXPECT_EQ(queues.connect_groups[0], 2u);
  EXPECT_EQ(queues.shadow_count[0], 65u);
  EXPECT_EQ(queues.extend_groups[0], 5u);
  EXPECT_EQ(queues.ray_count[0], 0u);
  EXPECT_EQ(queues.ray_count[1], 300u);
  EXPECT_EQ(queues.hit_count, 0u);
  EXPECT_EQ(queues.next_ray, 0u);
  EXPECT_EQ(bench.get_counters().bounce_rays[0], 300u);
  EXPECT_EQ(bench.get_counters().shadow_rays[0], 130u);
}

TEST_F(Kernels, AccumulateAddsExactly) {
  Scene scene = soup(1, 1, true);
  const PackedScene packed = pack(scene);
  Bench bench(device(), packed, packed.features, frame_of(packed, 8, 8));
  // 256 samples of each of 64 pixels: 0.1, whatever the sum has grown to; sample 7 of pixel 9 is not a number.
  std::vector<gpu::PathState> paths(kSlots);
  for (auto& path : paths) path.radiance = glm::vec3(0.1f, 1e-3f, 100.0f);
  paths[7 * 64 + 9].radiance.y = std::numeric_limits<float>::quiet_NaN();
  bench.paths.write(paths.data(), paths.size() * sizeof(gpu::PathState));
  const int waves = 40;
  for (int i = 0; i < waves; ++i)
    bench.run(wavepath_accumulate_spv, 1, {0, 64, static_cast<std::uint32_t>(i) * 256, 256, 0, 0});
  const auto film = download<gpu::FilmPixel>(bench.film, 128);
  for (std::uint32_t i = 0; i < 128; ++i) {
    const bool damaged = i == 9 * 2 + 1; // sample 7 belongs to the second replicate
    EXPECT_EQ(film[i].count, 128u * waves - (damaged ? waves : 0));
    const gpu::ExactSum* sums[3] = {&film[i].red, &film[i].green, &film[i].blue};
    for (int c = 0; c < 3; ++c) {
      const double expected = paths[0].radiance[c];
      EXPECT_DOUBLE_EQ(value_of(*sums[c], film[i].tops >> 8 * c & 0xff) / film[i].count, expected);
    }
  }
}

// Buffers are a little larger than asked for; the power of two that most devices have as their limit is still theirs
// alone.
TEST_F(Kernels, BindBuffersUpToTheDevicesLimit) {
  const std::uint64_t limit = device().info().max_storage_range;
  if (limit > std::uint64_t{1} << 28) GTEST_SKIP() << "would take much memory";
  for (const std::uint64_t bytes : {limit, std::bit_floor(limit)}) {
    const Buffer buffer(device(), bytes);
    const Binding bindings[] = {{0, BindingKind::storage, &buffer}, {1, BindingKind::texels_rgba32f, &buffer}};
    EXPECT_NO_THROW(BindingSet(device(), bindings, 4));
  }
  const Buffer larger(device(), limit + 1);
  const Binding bindings[] = {{0, BindingKind::storage, &larger}};
  EXPECT_THROW(BindingSet(device(), bindings, 4), Error);
}

// With quotients of floats as far off as devices may have them, and a little farther.
TEST(Division, IsThatOfIntegers) {
  const auto off_by = [](float quotient, int ulps) {
    return static_cast<std::uint32_t>(std::bit_cast<float>(std::bit_cast<std::int32_t>(quotient) + ulps));
  };
  for (const std::uint32_t b : {1u, 2u, 3u, 7u, 8u, 63u, 64u, 1000u, 4099u, 524'287u, 524'288u})
    for (std::uint32_t quotient = 0; quotient < 1u << 20; quotient += quotient < 5000 ? 1 : 4999)
      for (const std::uint64_t a : {std::uint64_t{quotient} * b, std::uint64_t{quotient} * b + b - 1}) {
        if (a >> 32) continue;
        const auto word = static_cast<std::uint32_t>(a);
        ASSERT_EQ(gpu::divide(word, b), quotient) << word << " / " << b;
        const bool is_small = word < 1u << 20;
        if (is_small) {
          ASSERT_EQ(gpu::divide_small(word, b), quotient) << word << " / " << b;
        }
        const auto divisor = static_cast<float>(b), exact = static_cast<float>(word) / divisor;
        const float between = (static_cast<float>(word) + 0.5f) / divisor;
        for (const int ulps : {-3, 3}) {
          const std::uint32_t rough = exact > 0.0f ? off_by(exact, ulps) : 0;
          ASSERT_EQ(gpu::corrected(rough, word, b), quotient) << word << " / " << b;
          if (is_small) {
            ASSERT_EQ(off_by(between, ulps), quotient) << word << " / " << b;
          }
        }
      }
}

TEST(TileOrder, VisitsEveryPixelOnce) {
  for (const auto& [width, height] : {std::pair{1u, 1u}, {8u, 8u}, {9u, 7u}, {64u, 24u}, {13u, 40u}}) {
    std::vector<int> seen(width * height, 0);
    for (std::uint32_t i = 0; i < width * height; ++i) {
      const glm::uvec2 p = gpu::pixel_in_tile_order(i, width, height);
      ASSERT_LT(p.x, width);
      ASSERT_LT(p.y, height);
      ++seen[p.y * width + p.x];
      ASSERT_EQ(gpu::tile_order_of(p, width, height), i);
    }
    for (const int times : seen) EXPECT_EQ(times, 1);
  }
}

TEST(TileOrder, HasAnInverseInTheLargestPictures) {
  for (const auto& [width, height] : {std::pair{65536u, 65535u}, {65535u, 7u}, {3u, 65536u}, {65531u, 65529u}}) {
    const std::uint64_t pixels = std::uint64_t{width} * height;
    for (std::uint64_t i = 0; i < pixels; i += std::max<std::uint64_t>(pixels / 9973, 1)) {
      const auto index = static_cast<std::uint32_t>(i);
      const glm::uvec2 p = gpu::pixel_in_tile_order(index, width, height);
      ASSERT_LT(p.x, width);
      ASSERT_LT(p.y, height);
      ASSERT_EQ(gpu::tile_order_of(p, width, height), index);
    }
  }
}

} // namespace
} // namespace wavepath::test
