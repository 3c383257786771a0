// A scene that is packed again with some of its meshes elsewhere is what pack() makes of it, but for the tree's shape.
#include <algorithm>
#include <cstring>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "bvh/validate.h"
#include "host/scene/pack/pack.h"
#include "host/scene/pack/pack_memory.h"
#include "tests/scene_builder.h"

namespace wavepath::test {
namespace {

constexpr std::uint32_t kTorn = 0; // the mesh with a triangle without area

struct Variant {
  bool has_twins, shines;
  bvh::Quality quality;
};

// Meshes of scattered triangles, in two primitives with normals. The last one is shown three times where there are
// twins.
Scene scattered_meshes(const Variant& variant, std::mt19937& random) {
  std::uniform_real_distribution<float> place(-4.0f, 4.0f), size(-0.7f, 0.7f);
  Scene scene;
  scene.path = "test";
  scene.materials = {plain_material(), plain_material(), plain_material()};
  scene.materials[1].alpha_mode = AlphaMode::blend;
  scene.materials[1].base_color.a = 0.5f;
  if (variant.shines) scene.materials[2].emission = {1.0f, 0.5f, 0.25f};
  for (std::uint32_t m = 0; m < 9; ++m) {
    std::vector<glm::vec3> positions;
    for (int t = 0; t < 60; ++t) {
      const glm::vec3 at(place(random), place(random), place(random));
      for (int k = 0; k < 3; ++k) positions.push_back(at + glm::vec3(size(random), size(random), size(random)));
    }
    if (m == kTorn) positions[4] = positions[3];
    Mesh& mesh = scene.meshes[add_mesh(scene, positions, m % 3)];
    mesh.primitives = {{0, 60, m % 3, true}, {60, 120, (m + 1) % 3, true}};
    for (const glm::vec3& p : positions) mesh.normals.push_back(glm::normalize(p + glm::vec3(0.1f, 9.0f, 0.2f)));
    mesh.content = new_content();
    scene.instances.push_back({m, glm::dmat4(1.0), m});
  }
  if (variant.has_twins)
    for (std::uint32_t i = 0; i < 2; ++i) scene.instances.push_back({8, glm::dmat4(1.0), 9 + i});
  return scene;
}

// The tree of an object by itself is sound.
void expect_sound(const PackedScene& packed, const Object& object) {
  bvh::WideTree tree;
  for (std::uint32_t n = object.root; n < object.root + object.node_count; ++n) {
    bvh::WideNode node = packed.nodes[n];
    node.first_child -= object.root, node.first_item -= object.first_item;
    tree.nodes.push_back(node);
  }
  tree.depth = object.depth;
  std::vector<bvh::Triangle> triangles;
  for (std::uint32_t i = 0; i < object.item_count; ++i) {
    const gpu::Triangle& t = packed.triangles[object.first_item + i];
    triangles.push_back({{t.v0.x, t.v0.y, t.v0.z}, {t.v1.x, t.v1.y, t.v1.z}, {t.v2.x, t.v2.y, t.v2.z}});
  }
  // Copies by spatial splits count as triangles of their own here, so that boxes of leaves need not hold all of them.
  if (triangles.size() != object.triangle_count) return;
  tree.order.resize(triangles.size());
  std::iota(tree.order.begin(), tree.order.end(), 0u);
  for (const std::string& wrong : bvh::validate(tree, std::span<const bvh::Triangle>(triangles)))
    ADD_FAILURE() << wrong;
}

// By id the bytes of a triangle, without its light, and those of its vertices. Copies are alike.
std::map<std::uint32_t, std::string> triangles_of(const PackedScene& packed, std::uint32_t first, std::uint32_t count) {
  std::map<std::uint32_t, std::string> all;
  for (std::uint32_t i = first; i < first + count; ++i) {
    gpu::Triangle triangle = packed.triangles[i];
    triangle.light = triangle.light == gpu::kNone ? 0 : 1 + triangle.light;
    std::string bytes(reinterpret_cast<const char*>(&triangle), sizeof(triangle));
    bytes.append(reinterpret_cast<const char*>(&packed.triangle_vertices[i]), sizeof(glm::uvec4));
    const auto [found, is_new] = all.emplace(triangle.id, bytes);
    EXPECT_EQ(found->second, bytes);
  }
  return all;
}

template <class T>
void expect_same_bytes(const std::vector<T>& a, const std::vector<T>& b, const char* what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  EXPECT_TRUE(a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0) << what;
}

void expect_like(const PackedScene& again, const PackMemory& memory, const PackedScene& fresh,
                 const PackMemory& of_fresh) {
  ASSERT_EQ(memory.objects.size(), of_fresh.objects.size());
  for (std::size_t i = 0; i < memory.objects.size(); ++i) {
    const Object &a = memory.objects[i], &b = of_fresh.objects[i];
    expect_sound(again, a);
    EXPECT_EQ(triangles_of(again, a.first_item, a.item_count), triangles_of(fresh, b.first_item, b.item_count)) << i;
  }
  EXPECT_EQ(again.dropped_triangles, fresh.dropped_triangles);
  EXPECT_EQ(again.triangle_count, fresh.triangle_count);
  EXPECT_EQ(again.features, fresh.features);
  expect_same_bytes(again.vertex_normals, fresh.vertex_normals, "normals");
  ASSERT_EQ(again.instances.size(), fresh.instances.size());
  for (std::size_t i = 0; i < again.instances.size(); ++i) {
    const gpu::Instance &a = again.instances[i], &b = fresh.instances[i];
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.first_light, b.first_light);
    EXPECT_EQ(std::memcmp(a.world_from_object, b.world_from_object, sizeof(a.world_from_object)), 0);
    EXPECT_EQ(a.root, memory.objects[memory.object_of[i]].root);
  }
  EXPECT_EQ(again.instance_nodes, fresh.instance_nodes);
  ASSERT_EQ(again.lights.size(), fresh.lights.size());
  for (std::size_t i = 0; i < again.lights.size(); ++i) {
    gpu::Light a = again.lights[i], b = fresh.lights[i];
    EXPECT_EQ(again.triangles[a.triangle].id, fresh.triangles[b.triangle].id);
    a.triangle = b.triangle = 0;
    EXPECT_EQ(std::memcmp(&a, &b, sizeof(a)), 0) << i;
  }
}

glm::dmat4 some_place(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  glm::dmat4 matrix =
      glm::translate(glm::dmat4(1.0), 3.0 * glm::dvec3(uniform(random), uniform(random), uniform(random)));
  matrix = glm::rotate(matrix, 3.0 * uniform(random), glm::normalize(glm::dvec3(uniform(random), 1.0, 0.3)));
  return glm::scale(matrix, glm::dvec3(uniform(random) < 0.0 ? -0.8 : 1.2, 1.0, 0.7)); // some mirror
}

class PackAgainTest : public testing::TestWithParam<Variant> {};

TEST_P(PackAgainTest, IsPackedAsFromTheStartWhereverMeshesGo) {
  std::mt19937 random(11);
  Scene scene = scattered_meshes(GetParam(), random);
  Packing packing;
  packing.quality = GetParam().quality;
  packing.eye = glm::dvec3(0.25, 0.5, 0.0);
  PackMemory memory;
  PackedScene packed = pack_again(scene, packing, memory);
  std::size_t taken_over = 0, built = 0;
  for (int step = 0; step < 30; ++step) {
    bool torn = false;
    for (int i = 0; i < 1 + step % 3 / 2; ++i) {
      // One mesh again and again, then others; or one of the twins.
      const std::size_t which = step < 8 ? 3 : random() % scene.instances.size();
      torn |= scene.instances[which].mesh == kTorn;
      scene.instances[which].world_from_object = some_place(random);
    }
    memory.packed = std::move(packed);
    memory.is_still = memory.other_materials = memory.other_images = memory.other_environment = false;
    packed = pack_again(scene, packing, memory);
    EXPECT_FALSE(memory.kept.geometry);
    EXPECT_TRUE(memory.kept.places || torn || (GetParam().has_twins && packing.quality != bvh::Quality::fast)) << step;
    taken_over += memory.kept.places;
    if (step > 0 && step < 8) built += memory.trees.built;
    PackMemory of_fresh;
    const PackedScene fresh = pack_again(scene, packing, of_fresh);
    expect_like(packed, memory, fresh, of_fresh);
  }
  EXPECT_GT(taken_over, 10u);
  EXPECT_EQ(built, 7u * 60u); // that moved
}

// What else is other is not taken over.
TEST_P(PackAgainTest, OtherMeshesAreNoMovedOnes) {
  std::mt19937 random(12);
  Scene scene = scattered_meshes(GetParam(), random);
  Packing packing;
  packing.quality = GetParam().quality;
  packing.eye = glm::dvec3(0.25, 0.5, 0.0);
  PackMemory memory;
  PackedScene packed = pack_again(scene, packing, memory);
  const auto expect_anew = [&](const char* what) {
    memory.packed = std::move(packed);
    memory.is_still = memory.other_images = memory.other_environment = false;
    memory.other_materials = true;
    packed = pack_again(scene, packing, memory);
    EXPECT_FALSE(memory.kept.places) << what;
    PackMemory of_fresh;
    const PackedScene fresh = pack_again(scene, packing, of_fresh);
    expect_like(packed, memory, fresh, of_fresh);
  };
  for (std::size_t v = 0; v < 60; ++v)
    scene.meshes[2].positions[v] += glm::vec3(0.2f, 0.01f * static_cast<float>(v), 0.0f);
  scene.meshes[2].content = new_content();
  expect_anew("a mesh of another shape");
  scene.meshes[2].content = 0;
  expect_anew("a mesh of which nothing is known");
  expect_anew("and again");
  scene.meshes[2].content = new_content();
  expect_anew("a mesh that becomes known");
  std::swap(scene.instances[1], scene.instances[2]);
  expect_anew("instances in another order");
  scene.instances.erase(scene.instances.begin() + 4);
  expect_anew("an instance less");
  scene.materials[1].alpha_mode = AlphaMode::opaque;
  expect_anew("a material that rays ask no more");
  packing.eye = glm::dvec3(1.0);
  expect_anew("another origin");
  packing.near = {glm::dvec3(scene.meshes[1].positions[0]) + glm::dvec3(1e-3)};
  expect_anew("a triangle that is cut");
  packing.near = {};
  expect_anew("and is no more");
}

// Of two bodies that overlap, that with the smaller box counts.
TEST(PackAgainBodies, TakeOtherPlacesAsTheyGrow) {
  Scene scene;
  scene.path = "test";
  for (int m = 0; m < 2; ++m) {
    scene.materials.push_back(plain_material());
    scene.materials.back().transmission = 1.0f;
    scene.materials.back().volume = true;
    const std::uint32_t mesh = add_mesh(scene, {{0, 0, 0}, {1, 0, 0}, {0, 1, 1}, {0, 0, 0}, {0, 1, 0}, {1, 0, 1}},
                                        static_cast<std::uint32_t>(m));
    scene.meshes[mesh].content = new_content();
    add_instance(scene, mesh, glm::scale(glm::dmat4(1.0), glm::dvec3(1.0 + m)));
  }
  Packing packing;
  packing.eye = glm::dvec3(0.5);
  PackMemory memory;
  PackedScene packed = pack_again(scene, packing, memory);
  const PackedScene first = pack(scene, packing);
  expect_same_bytes(packed.materials, first.materials, "materials");
  scene.instances[0].world_from_object = glm::scale(glm::dmat4(1.0), glm::dvec3(3.0));
  memory.packed = std::move(packed);
  memory.is_still = memory.other_materials = memory.other_images = memory.other_environment = false;
  packed = pack_again(scene, packing, memory);
  const PackedScene fresh = pack(scene, packing);
  EXPECT_NE(fresh.materials[0].flags, first.materials[0].flags);
  expect_same_bytes(packed.materials, fresh.materials, "materials");
  EXPECT_TRUE(memory.kept.places);
}

INSTANTIATE_TEST_SUITE_P(Variants, PackAgainTest,
                         testing::Values(Variant{false, false, bvh::Quality::fast},
                                         Variant{false, true, bvh::Quality::fast},
                                         Variant{true, true, bvh::Quality::fast},
                                         Variant{true, false, bvh::Quality::balanced},
                                         Variant{false, true, bvh::Quality::best}));

} // namespace
} // namespace wavepath::test
