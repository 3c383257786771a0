// Rays traced by the device's ray queries: when they are, and that they find what our own traversal finds. Drivers
// without them, such as Mesa 22.3's for CPUs, skip what needs them.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "host/base/error.h"
#include "host/bench/ray_replay.h"
#include "host/render/render.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/traversal.h"
#include "host/render/workspace/query_scene.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/scene_builder.h"
#include "tests/shared_kernels.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

template <class Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Traversal, IsTheDevicesWhereItHasHardware) {
  DeviceInfo gpu, cpu;
  gpu.name = "a GPU", gpu.type = "discrete", gpu.has_ray_queries = true;
  cpu.name = "a CPU", cpu.type = "cpu", cpu.has_ray_queries = true;
  EXPECT_TRUE(traces_by_query(kTraversalAuto, gpu));
  EXPECT_FALSE(traces_by_query(kTraversalCompute, gpu));
  EXPECT_FALSE(traces_by_query(kTraversalAuto, cpu)) << "drivers for CPUs take ten times as long as we do";
  EXPECT_TRUE(traces_by_query(kTraversalHardware, cpu));
  gpu.has_ray_queries = false;
  EXPECT_FALSE(traces_by_query(kTraversalAuto, gpu));
  EXPECT_NE(message_of([&] { traces_by_query(kTraversalHardware, gpu); }).find("a GPU: has no ray queries"),
            std::string::npos);
}

TEST(Traversal, OfWhatMovesIsOurOwn) {
  RenderPlan settings;
  settings.moving = true;
  EXPECT_EQ(traversal_of(settings), kTraversalCompute);
  settings.traversal = kTraversalHardware;
  EXPECT_NE(message_of([&] { traversal_of(settings); }).find("move"), std::string::npos);
  settings.moving = false;
  EXPECT_EQ(traversal_of(settings), kTraversalHardware);
}

struct Loaded {
  PackedScene packed;
  View view;
};

Loaded load(Scene scene, const RenderPlan& settings) {
  const View view = resolve_view(scene, {}, settings.width, settings.height);
  return {pack(scene), view};
}

// Where the source tree is not at hand (benchmarks/gpu_day.sh), WAVEPATH_SCENES names the folder.
Scene shipped(const char* name) {
  const char* folder = std::getenv("WAVEPATH_SCENES");
  return load_gltf(std::string(folder ? folder : WAVEPATH_SOURCE_DIR "/scenes") + "/" + name, {});
}

// Tumbled triangles in a ball, some of them MASK or BLEND, shown often: turned, stretched and mirrored.
Scene tumbled_scene() {
  Scene scene;
  scene.path = "test";
  scene.materials.assign(3, plain_material());
  scene.materials[1].alpha_mode = AlphaMode::blend;
  scene.materials[1].base_color.a = 0.5f;
  scene.materials[2].double_sided = false;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(-1.0f, 1.0f);
  for (std::uint32_t material = 0; material < 3; ++material) {
    std::vector<glm::vec3> corners;
    for (int i = 0; i < 200; ++i) {
      const glm::vec3 middle(place(random), place(random), place(random));
      for (int k = 0; k < 3; ++k)
        corners.push_back(middle + 0.4f * glm::vec3(place(random), place(random), place(random)));
    }
    const std::uint32_t mesh = add_mesh(scene, corners, material);
    for (int i = 0; i < 6; ++i) {
      glm::dmat4 m = glm::translate(glm::dmat4(1.0), glm::dvec3(place(random), place(random), place(random)) * 3.0);
      m = glm::rotate(m, double{place(random)} * 3.0, glm::dvec3(1.0, 2.0, 3.0));
      add_instance(scene, mesh, glm::scale(m, glm::dvec3(1.0, 0.5 + 0.2 * i, i % 2 == 0 ? 1.0 : -1.0)));
    }
  }
  // Alone, and large: cut into copies by spatial splits.
  add_instance(scene,
               add_mesh(scene, {{-9, -4, -9}, {9, -4.5f, -9}, {0, -4, 12}, {-9, 5, -9}, {8, 4, -9}, {1, -5, -7}}));
  PunctualLight sun;
  sun.kind = LightKind::directional;
  sun.direction = glm::normalize(glm::dvec3(0.3, -1.0, 0.2));
  sun.intensity = glm::vec3(3.0f);
  scene.lights.push_back(sun);
  return scene;
}

class RayQuery : public VulkanTest {
protected:
  void SetUp() override {
    VulkanTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    if (!device().info().has_ray_queries) GTEST_SKIP() << device().info().name << " has no ray queries";
    settings_.width = 64, settings_.height = 48;
    settings_.last_sample = 2;
    settings_.max_depth = 4;
    settings_.kernels.shadow_rays = true;
    by_query_ = settings_;
    settings_.traversal = kTraversalCompute;
    by_query_.traversal = kTraversalHardware;
  }

  // Of those rays that differ, single ones at edges and among surfaces at the same place may.
  void expect_equal_hits(const Loaded& scene) {
    KernelCompiler& kernels = shared_kernels(device());
    RayReplay ours(device(), scene.packed, scene.view, settings_, kernels),
        theirs(device(), scene.packed, scene.view, by_query_, kernels);
    const RaySets rays = ours.capture();
    for (const auto* set : {&rays.camera, &rays.bounce}) {
      ASSERT_GT(set->size(), 100u);
      ours.extend(*set, set == &rays.camera);
      theirs.extend(*set, set == &rays.camera);
      const std::vector<gpu::Hit> a = ours.hits(set->size()), b = theirs.hits(set->size());
      std::size_t different = 0, hits = 0;
      for (std::size_t i = 0; i < a.size(); ++i) {
        const bool hit = a[i].triangle != gpu::kNone && b[i].triangle != gpu::kNone;
        hits += hit;
        const bool same = hit ? scene.packed.triangles[a[i].triangle].id == scene.packed.triangles[b[i].triangle].id &&
                                    a[i].instance == b[i].instance && a[i].b1 == b[i].b1 && a[i].b2 == b[i].b2
                              : a[i].triangle == b[i].triangle;
        different += !same;
      }
      EXPECT_GT(hits, a.size() / 10);
      EXPECT_LE(different, a.size() / 1000);
    }
    ASSERT_GT(rays.shadow.size(), 100u);
    ours.connect(rays.shadow);
    theirs.connect(rays.shadow);
    const std::vector<bool> a = ours.blocked(rays.shadow), b = theirs.blocked(rays.shadow);
    std::size_t different = 0;
    for (std::size_t i = 0; i < a.size(); ++i) different += a[i] != b[i];
    EXPECT_LE(different, a.size() / 1000);
  }

  // Nearly all pixels have the same bits.
  void expect_equal_pictures(const Loaded& scene, const IntegratorKind& kind) {
    SCOPED_TRACE(kind.name);
    settings_.integrator = by_query_.integrator = &kind;
    const RenderResult ours = render(device(), scene.packed, scene.view, settings_);
    const RenderResult theirs = render(device(), scene.packed, scene.view, by_query_);
    EXPECT_FALSE(ours.by_query);
    EXPECT_TRUE(theirs.by_query);
    const std::vector<float>&a = ours.picture.channels[0].values, &b = theirs.picture.channels[0].values;
    std::size_t different = 0, lit = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      different += std::fabs(a[i] - b[i]) > 1e-4f * (a[i] + 1e-3f); // sums over a frame may carry a bit elsewhere
      lit += a[i] > 0.0f;
    }
    EXPECT_GT(lit, a.size() / 10);
    EXPECT_LE(different, a.size() / 100);
  }

  RenderPlan settings_, by_query_;
};

TEST_F(RayQuery, FindsWhatTraversalFinds) { expect_equal_hits(load(shipped("cornell_box.gltf"), settings_)); }
TEST_F(RayQuery, FindsItThroughAlphaAndPanes) { expect_equal_hits(load(shipped("showcase.glb"), settings_)); }
TEST_F(RayQuery, FindsItAmongInstances) {
  const Loaded scene = load(tumbled_scene(), settings_);
  ASSERT_TRUE(scene.packed.root_is_top);
  expect_equal_hits(scene);
}

// Drivers find the surface that a ray starts at again as rounding has it. A ray that by our arithmetic leaves it goes
// on.
TEST_F(RayQuery, RaysLeaveTheSurfaceThatTheyStartAt) {
  Scene scene = triangle_scene();
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-1.0f, 1.0f), unit(0.0f, 1.0f);
  std::vector<glm::vec3> corners;
  for (int i = 0; i < 900; ++i) corners.push_back(10.0f * glm::vec3(place(random), place(random), place(random)));
  add_instance(scene, add_mesh(scene, corners));
  const Loaded loaded = load(std::move(scene), settings_);
  KernelCompiler& kernels = shared_kernels(device());
  RayReplay ours(device(), loaded.packed, loaded.view, settings_, kernels),
      theirs(device(), loaded.packed, loaded.view, by_query_, kernels);
  std::vector<gpu::Ray> rays(2000);
  std::vector<std::uint32_t> started;
  for (gpu::Ray& ray : rays) {
    const gpu::Triangle& t = loaded.packed.triangles[random() % loaded.packed.triangles.size()];
    started.push_back(t.id);
    const float u = unit(random), v = unit(random) * (1.0f - u);
    const glm::vec3 way(place(random), place(random), place(random));
    ray = {t.v0 + u * (t.v1 - t.v0) + v * (t.v2 - t.v0), 0, glm::normalize(way), gpu::kFar};
  }
  ours.extend(rays, false);
  theirs.extend(rays, false);
  const std::vector<gpu::Hit> a = ours.hits(rays.size()), b = theirs.hits(rays.size());
  std::size_t different = 0, leaving = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto id = [&](const gpu::Hit& hit) {
      return hit.triangle == gpu::kNone ? gpu::kNone : loaded.packed.triangles[hit.triangle].id;
    };
    if (id(a[i]) == started[i]) continue;
    ++leaving;
    different += id(a[i]) != id(b[i]);
  }
  EXPECT_GT(leaving, rays.size() / 2);
  EXPECT_LE(different, leaving / 500);
}

TEST_F(RayQuery, GivesEveryIntegratorTheSamePicture) {
  const Loaded room = load(shipped("cornell_box.gltf"), settings_), tumbled = load(tumbled_scene(), settings_);
  for (const IntegratorKind* kind : integrators()) {
    expect_equal_pictures(room, *kind);
    expect_equal_pictures(tumbled, *kind);
  }
}

// Each sheet takes half of the light, once, however many copies of its triangles a tree of ours would hold.
TEST_F(RayQuery, SheetsDimShadowsOnce) {
  Scene scene;
  scene.path = "test";
  scene.materials.assign(2, plain_material());
  scene.materials[1].alpha_mode = AlphaMode::blend;
  scene.materials[1].base_color = {0.0f, 0.0f, 0.0f, 0.5f};
  add_instance(scene, add_mesh(scene, {{-50, 0, -50}, {0, 0, 50}, {50, 0, -50}}));
  for (int sheet = 1; sheet <= 3; ++sheet) {
    const auto y = static_cast<float>(10 + sheet);
    add_instance(scene, add_mesh(scene, {{-90, y, -90}, {0, y + 0.5f, 90}, {90, y, -90}}, 1));
  }
  PunctualLight sun;
  sun.kind = LightKind::directional;
  sun.direction = {0.0, -1.0, 0.0};
  scene.lights.push_back(sun);
  by_query_.max_depth = 1;
  const PackedScene packed = pack(scene);
  View view;
  view.position = {0.0, 5.0, 0.0};
  view.forward = {0.0, -1.0, 0.0};
  view.right = {0.2, 0.0, 0.0};
  view.up = {0.0, 0.0, -0.2};
  const RenderResult result = render(device(), packed, view, by_query_);
  const double expected = 0.5 / M_PI / 8.0;
  for (const float value : result.picture.channels[0].values) EXPECT_NEAR(value, expected, 1e-5 * expected);
}

TEST_F(RayQuery, LeavesOutOurTree) {
  const Loaded scene = load(shipped("showcase.glb"), settings_);
  const DeviceScene ours = upload_scene(device(), scene.packed), theirs = upload_scene(device(), scene.packed, true);
  EXPECT_FALSE(ours.queries);
  ASSERT_TRUE(theirs.queries);
  EXPECT_LT(theirs.nodes.bytes(), ours.nodes.bytes());
  EXPECT_GT(theirs.queries->bytes(), 0u);
  const QueryScene scene_of_queries = make_query_scene(device(), scene.packed);
  EXPECT_EQ(scene_of_queries.items.size() % 4, 0u);
}

TEST_F(RayQuery, KnowsScenesWithoutTriangles) {
  Scene scene;
  scene.path = "test";
  scene.environment.radiance = glm::vec3(1.0f);
  settings_.last_sample = by_query_.last_sample = 1;
  const PackedScene packed = pack(scene);
  View view;
  const RenderResult result = render(device(), packed, view, by_query_);
  EXPECT_TRUE(result.by_query);
}

} // namespace
} // namespace wavepath::test
