// Geometry as packed: origin, baking, winding, instancing, streams, dropped triangles, trees and stack bounds.
#include "host/scene/pack/pack.h"
#include "bvh/words.h"
#include "host/scene/pack/vertices.h"

#include <algorithm>
#include <bit>
#include <filesystem>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/features.h"
#include "tests/scene_builder.h"

namespace wavepath {
namespace {

const glm::dmat4 kMirror = glm::scale(glm::dmat4(1.0), glm::dvec3(-1.0, 1.0, 1.0));

glm::dmat4 moved(double x, double y, double z) { return glm::translate(glm::dmat4(1.0), glm::dvec3(x, y, z)); }

glm::vec3 face_normal(const gpu::Triangle& t) { return glm::normalize(glm::cross(t.v1 - t.v0, t.v2 - t.v0)); }

glm::dvec3 apply(const glm::vec4 (&rows)[3], const glm::dvec3& p) {
  const glm::dvec4 q(p, 1.0);
  return {glm::dot(glm::dvec4(rows[0]), q), glm::dot(glm::dvec4(rows[1]), q), glm::dot(glm::dvec4(rows[2]), q)};
}

bool warned(const Scene& scene, const std::string& words, std::size_t count) {
  for (const auto& [text, times] : scene.warnings.counts())
    if (text.find(words) != std::string::npos) return times == count;
  return false;
}

// Many small triangles at random places within the unit cube.
std::vector<glm::vec3> triangle_cloud(std::size_t count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform;
  const auto point = [&] { return glm::vec3(uniform(random), uniform(random), uniform(random)); };
  std::vector<glm::vec3> positions;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 centre = point();
    for (int k = 0; k < 3; ++k) positions.push_back(centre + 0.02f * point());
  }
  return positions;
}

// Walks a subtree of the packed nodes. `visit(item, box)` gets every leaf item with the box that guards it. Returns the
// nodes on the longest path.
template <typename Visit>
std::uint32_t walk(const PackedScene& packed, std::uint32_t index, const Visit& visit) {
  if (index >= packed.nodes.size()) {
    ADD_FAILURE() << "node " << index << " is beyond the nodes";
    return 0;
  }
  const bvh::WideNode& node = packed.nodes[index];
  std::uint32_t deepest = 0;
  for (std::uint32_t slot = 0; slot < 4; ++slot) {
    const std::uint32_t first = bvh::first_item(node, slot);
    for (std::uint32_t item = first; item < first + bvh::item_count(node, slot); ++item)
      visit(item, bvh::child_box(node, slot));
    if (bvh::is_inner(node, slot)) deepest = std::max(deepest, walk(packed, node.first_child + slot, visit));
  }
  return deepest + 1;
}

bool inside(const glm::dvec3& p, const bvh::GridBox& box) {
  bool all = true;
  for (int axis = 0; axis < 3; ++axis) all = all && p[axis] >= box.lo[axis] && p[axis] <= box.hi[axis];
  return all;
}

// Every triangle of [first, first + count) hangs in exactly one leaf of `root`, inside its box.
std::uint32_t check_object(const PackedScene& packed, std::uint32_t root, std::vector<int>& seen) {
  return walk(packed, root, [&](std::uint32_t t, const bvh::GridBox& box) {
    ASSERT_LT(t, packed.triangles.size());
    ++seen[t];
    const gpu::Triangle& triangle = packed.triangles[t];
    EXPECT_TRUE(inside(triangle.v0, box) && inside(triangle.v1, box) && inside(triangle.v2, box));
  });
}

TEST(Pack, PutsTheOriginIntoTheMiddleOfTheGeometry) {
  Scene scene = triangle_scene();
  scene.instances[0].world_from_object = moved(1e6, -2e6, 3e6);
  const PackedScene packed = pack(scene);
  EXPECT_EQ(packed.origin, glm::dvec3(1e6 + 0.5, -2e6 + 0.5, 3e6));
  ASSERT_EQ(packed.triangles.size(), 1u);
  EXPECT_EQ(packed.triangles[0].v0, glm::vec3(-0.5f, -0.5f, 0.0f));
  EXPECT_EQ(packed.triangles[0].v1, glm::vec3(0.5f, -0.5f, 0.0f));
  EXPECT_EQ(packed.triangles[0].v2, glm::vec3(-0.5f, 0.5f, 0.0f));
  EXPECT_DOUBLE_EQ(packed.radius, std::sqrt(0.5));
}

TEST(Pack, IsTheSameSceneWhereverItStands) {
  Scene near = triangle_scene();
  near.meshes[0].positions = triangle_cloud(100);
  near.meshes[0].indices.resize(300);
  for (std::uint32_t i = 0; i < 300; ++i) near.meshes[0].indices[i] = i;
  near.meshes[0].primitives[0].index_count = 300;
  Scene far = near;
  far.instances[0].world_from_object = moved(0x1p20, -0x1p20, 0x1p20); // exact sums, so that nothing may differ
  const PackedScene a = pack(near), b = pack(far);
  ASSERT_EQ(a.triangles.size(), 100u);
  for (std::size_t t = 0; t < 100; ++t) {
    EXPECT_EQ(a.triangles[t].v0, b.triangles[t].v0);
    EXPECT_EQ(a.triangles[t].v2, b.triangles[t].v2);
  }
}

TEST(Pack, KeepsMirroredTrianglesCounterClockwise) {
  Scene scene = triangle_scene();
  Mesh& mesh = scene.meshes[0];
  mesh.normals.assign(3, glm::normalize(glm::vec3(1, 0, 1)));
  mesh.tangents.assign(3, glm::vec4(glm::normalize(glm::vec3(1, 0, -1)), 1.0f));
  mesh.primitives[0].has_normals = true;
  scene.instances[0].world_from_object = kMirror;
  const PackedScene packed = pack(scene);
  EXPECT_EQ(face_normal(packed.triangles[0]), glm::vec3(0, 0, 1));
  EXPECT_EQ(packed.triangle_vertices[0], glm::uvec4(0, 2, 1, 0));
  EXPECT_EQ(packed.triangles[0].v1, glm::vec3(0.5f, 0.5f, 0.0f)); // the object's v2, (0,1,0)
  const glm::vec3 n(packed.vertex_normals[0]);
  EXPECT_NEAR(n.x, -std::sqrt(0.5f), 1e-6f);
  EXPECT_NEAR(n.z, std::sqrt(0.5f), 1e-6f);
  // t' = M t and cross(n', t') * w' = M (cross(n, t) * w): the bitangent (0,-1,0) stays where it is, so that w' is -1.
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(packed.vertex_normals[0].w);
  EXPECT_EQ(bits & 1u, 1u);
}

TEST(Pack, TurnsNormalsByTheInverseTranspose) {
  Scene scene = triangle_scene();
  scene.meshes[0].normals.assign(3, glm::normalize(glm::vec3(1, 1, 0)));
  scene.meshes[0].primitives[0].has_normals = true;
  scene.instances[0].world_from_object = glm::scale(glm::dmat4(1.0), glm::dvec3(2.0, 1.0, 1.0));
  const PackedScene packed = pack(scene);
  const glm::vec3 expected = glm::normalize(glm::vec3(0.5f, 1.0f, 0.0f));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(packed.vertex_normals[0][c], expected[c], 1e-6f);
  EXPECT_NE(packed.triangles[0].surface & gpu::kTriangleSmooth, 0u);
}

TEST(Pack, LeavesOutStreamsThatNothingReads) {
  Scene scene = triangle_scene();
  const PackedScene bare = pack(scene);
  EXPECT_TRUE(bare.triangle_vertices.empty() && bare.vertex_normals.empty() && bare.vertex_uvs.empty() &&
              bare.vertex_colors.empty());
  EXPECT_EQ(bare.features, 0u);

  scene.meshes[0].colors.assign(3, glm::vec4(0.25f, 0.5f, 0.75f, 1.0f));
  scene.meshes[0].uvs[0].assign(3, glm::vec2(0.5f)); // no texture asks for them
  const PackedScene colored = pack(scene);
  EXPECT_EQ(colored.triangle_vertices.size(), 1u);
  ASSERT_EQ(colored.vertex_colors.size(), 3u);
  EXPECT_EQ(colored.vertex_colors[2], glm::vec4(0.25f, 0.5f, 0.75f, 1.0f));
  EXPECT_TRUE(colored.vertex_normals.empty() && colored.vertex_uvs.empty());
  EXPECT_EQ(colored.features, gpu::kFeatureVertexColors);
}

TEST(Pack, FillsStreamsForMeshesThatLackThem) {
  Scene scene = triangle_scene();
  scene.meshes[0].colors.assign(3, glm::vec4(0.0f));
  add_instance(scene, add_mesh(scene, kUnitTriangle), moved(0, 0, 1));
  const PackedScene packed = pack(scene);
  ASSERT_EQ(packed.vertex_colors.size(), 6u);
  EXPECT_EQ(packed.vertex_colors[0], glm::vec4(0.0f));
  EXPECT_EQ(packed.vertex_colors[5], glm::vec4(1.0f)); // white where a mesh has no colours
  for (std::size_t t = 0; t < 2; ++t) {
    const std::uint32_t first =
        packed.triangles[t].v0.z > 0.0f ? 3u : 0u; // the second mesh's vertices follow the first's
    EXPECT_EQ(packed.triangle_vertices[t], glm::uvec4(first, first + 1, first + 2, 0));
  }
}

TEST(Pack, ZeroesTextureCoordinatesThatAreNotFinite) {
  Scene scene = triangle_scene();
  scene.images.push_back({"image", 1, 1, {255, 255, 255, 255}, {}});
  scene.materials[0].base_color_texture.image = 0;
  scene.meshes[0].uvs[0] = {
      {0.25f, 0.5f}, {std::numeric_limits<float>::quiet_NaN(), 0.0f}, {0.0f, std::numeric_limits<float>::infinity()}};
  const PackedScene packed = pack(scene);
  EXPECT_EQ(packed.vertex_uvs[0], glm::vec4(0.25f, 0.5f, 0.0f, 0.0f));
  EXPECT_EQ(packed.vertex_uvs[1], glm::vec4(0.0f));
  EXPECT_EQ(packed.vertex_uvs[2], glm::vec4(0.0f));
  EXPECT_TRUE(warned(scene, "texture coordinates", 2));
}

TEST(Pack, DropsDegenerateAndInfiniteTrianglesAndNothingElse) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  std::vector<glm::vec3> positions = kUnitTriangle;
  const std::vector<std::vector<glm::vec3>> bad = {
      {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}},     // a repeated vertex
      {{0, 0, 0}, {1, 1, 1}, {3, 3, 3}},     // collinear
      {{nan, 0, 0}, {1, 0, 0}, {0, 1, 0}},   // not a number
      {{0, 0, 0}, {inf, 0, 0}, {0, 1, 0}},   // infinite
      {{0, 0, 0}, {1e30f, 0, 0}, {0, 1, 0}}, // too large to compute with
  };
  for (const auto& triangle : bad) positions.insert(positions.end(), triangle.begin(), triangle.end());
  Scene scene;
  scene.materials.push_back(plain_material());
  add_instance(scene, add_mesh(scene, positions));
  const PackedScene packed = pack(scene);
  EXPECT_EQ(packed.origin, glm::dvec3(1.5, 1.5, 1.5)); // the degenerate ones are finite, and count for the box
  EXPECT_EQ(packed.dropped_triangles, 5u);
  EXPECT_EQ(packed.triangle_count, packed.triangles.size());
  EXPECT_TRUE(warned(scene, "without area", 5));
  ASSERT_EQ(packed.triangles.size(), 1u);
  EXPECT_EQ(packed.triangles[0].v0, glm::vec3(-1.5f));
  EXPECT_EQ(packed.triangles[0].v1, glm::vec3(-0.5f, -1.5f, -1.5f));
}

TEST(Pack, IsNotMovedByVerticesThatAreNotFinite) {
  Scene clean = triangle_scene();
  Scene poisoned = clean;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  poisoned.meshes[0].positions.insert(poisoned.meshes[0].positions.end(), {{5, 5, 5}, {nan, 5, 5}, {5, 1e30f, 5}});
  poisoned.meshes[0].indices.insert(poisoned.meshes[0].indices.end(), {3, 4, 5});
  poisoned.meshes[0].primitives[0].index_count = 6;
  const PackedScene a = pack(clean), b = pack(poisoned);
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.radius, b.radius);
  ASSERT_EQ(b.triangles.size(), 1u);
  EXPECT_EQ(a.triangles[0].v1, b.triangles[0].v1);
}

TEST(Pack, KeepsThinTrianglesThatHaveAnArea) {
  Scene scene;
  scene.materials.push_back(plain_material());
  add_instance(scene, add_mesh(scene, {{-1, -1, 0}, {1, -1, 0}, {1, -1 + 0x1p-23f, 0}}));
  EXPECT_EQ(pack(scene).triangles.size(), 1u);
}

TEST(Pack, HoldsAnEmptyScene) {
  Scene scene;
  const PackedScene empty = pack(scene);
  EXPECT_TRUE(empty.triangles.empty() && empty.lights.empty());
  EXPECT_FALSE(empty.root_is_top);
  EXPECT_EQ(walk(empty, empty.root, [](std::uint32_t, const bvh::GridBox&) { FAIL() << "there is no item"; }), 1u);
  EXPECT_EQ(empty.origin, glm::dvec3(0.0));
}

TEST(Pack, BuildsAValidTreeOfOneLevel) {
  Scene scene;
  scene.materials.push_back(plain_material());
  add_instance(scene, add_mesh(scene, triangle_cloud(5000)), moved(100, 0, 0));
  const PackedScene packed = pack(scene);
  EXPECT_FALSE(packed.root_is_top);
  EXPECT_TRUE(packed.instances.empty());
  std::vector<int> seen(packed.triangles.size(), 0);
  const std::uint32_t depth = check_object(packed, packed.root, seen);
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), 5000);
  EXPECT_EQ(packed.stack_size, depth);
}

// Two shared meshes and a static one, mirrored and scaled instances among them.
Scene instanced_scene() {
  Scene scene;
  scene.materials.push_back(plain_material());
  const std::uint32_t cloud = add_mesh(scene, triangle_cloud(300)), single = add_mesh(scene, kUnitTriangle),
                      other = add_mesh(scene, triangle_cloud(40));
  for (int i = 0; i < 20; ++i)
    add_instance(scene, cloud, glm::rotate(moved(3.0 * i + 1e6, 0.1 * i, 0), 0.37 * i, glm::dvec3(0.3, 1.0, 0.2)));
  add_instance(scene, single, moved(1e6, 5, 0));
  add_instance(scene, other, moved(1e6, 0, 7) * kMirror);
  add_instance(scene, other, glm::scale(moved(1e6, 0, -7), glm::dvec3(3.0, 0.01, 1.0)));
  return scene;
}

TEST(PackInstances, StoresSharedMeshesOnceAndTheRestAsOneMoreInstance) {
  Scene scene = instanced_scene();
  const PackedScene packed = pack(scene);
  EXPECT_TRUE(packed.root_is_top);
  EXPECT_EQ(packed.triangles.size(), 341u);
  EXPECT_EQ(packed.triangle_count, 20u * 300u + 1u + 2u * 40u);
  EXPECT_EQ(packed.instances.size(), 23u);
  EXPECT_EQ(packed.features, gpu::kFeatureInstances);
  EXPECT_EQ(std::count_if(packed.instances.begin(), packed.instances.end(),
                          [](const gpu::Instance& i) { return i.flipped == 1; }),
            1);
}

TEST(PackInstances, BuildsValidTreesOfBothLevels) {
  Scene scene = instanced_scene();
  const PackedScene packed = pack(scene);
  std::vector<int> seen(packed.triangles.size(), 0), placed(packed.instances.size(), 0);
  std::vector<std::uint32_t> roots;
  std::uint32_t deepest = 0;
  const std::uint32_t top = walk(packed, packed.root, [&](std::uint32_t i, const bvh::GridBox& box) {
    ++placed[i];
    const gpu::Instance& instance = packed.instances[i];
    walk(packed, instance.root, [&](std::uint32_t t, const bvh::GridBox&) {
      for (const glm::vec3& v : {packed.triangles[t].v0, packed.triangles[t].v1, packed.triangles[t].v2})
        EXPECT_TRUE(inside(apply(instance.world_from_object, v), box));
    });
    if (std::find(roots.begin(), roots.end(), instance.root) != roots.end()) return;
    roots.push_back(instance.root);
    deepest = std::max(deepest, check_object(packed, instance.root, seen));
  });
  EXPECT_EQ(roots.size(), 3u);
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), 341);
  EXPECT_EQ(std::count(placed.begin(), placed.end(), 1), 23);
  EXPECT_EQ(packed.stack_size, top + 1 + 7 + 1 + deepest);
}

TEST(PackInstances, HaveOneLeafEach) {
  Scene scene = triangle_scene();
  for (int i = 0; i < 30; ++i) add_instance(scene, 0); // all in one place, where a leaf of several would be cheapest
  const PackedScene packed = pack(scene);
  std::size_t leaves = 0;
  for (const bvh::WideNode& node : packed.nodes)
    for (std::uint32_t slot = 0; slot < 4; ++slot) leaves += bvh::is_leaf(node, slot);
  leaves -= 1; // of the mesh's own tree
  for (std::uint32_t slot = 0; slot < 4; ++slot) EXPECT_LE(bvh::item_count(packed.nodes[packed.root], slot), 1u);
  EXPECT_EQ(leaves, packed.instances.size());
}

TEST(PackInstances, ComposeTheirMatricesInDoubleAroundTheOrigin) {
  Scene scene = triangle_scene();
  scene.instances[0].world_from_object = moved(1e7, 0, 0);
  add_instance(scene, 0, moved(1e7 + 0.125, 0, 0) * kMirror);
  const PackedScene packed = pack(scene);
  ASSERT_EQ(packed.instances.size(), 2u);
  const gpu::Instance& plain = packed.instances[packed.instances[0].flipped ? 1 : 0];
  const gpu::Instance& mirrored = packed.instances[packed.instances[0].flipped ? 0 : 1];
  EXPECT_EQ(mirrored.flipped, 1u);
  // At 1e7 a float has steps of 1: rebasing after rounding would lose the eighth.
  EXPECT_FLOAT_EQ(mirrored.world_from_object[0].w - plain.world_from_object[0].w, 0.125f);
  for (const gpu::Instance& instance : packed.instances) {
    const glm::dvec3 p(0.3, 0.6, -0.2);
    const glm::dvec3 back = apply(instance.object_from_world, apply(instance.world_from_object, p));
    EXPECT_LT(glm::length(back - p), 1e-6);
  }
  EXPECT_EQ(packed.triangles.size(), 1u); // shared, in its own space and winding
  EXPECT_EQ(packed.triangles[0].v1, glm::vec3(1, 0, 0));
}

TEST(PackInstances, ThatFloatsCannotHoldAreDroppedWithAWarning) {
  Scene scene = triangle_scene();
  add_instance(scene, 0, glm::scale(glm::dmat4(1.0), glm::dvec3(1e30)));
  add_instance(scene, 0, moved(1, 1, 1));
  const PackedScene packed = pack(scene);
  EXPECT_EQ(packed.instances.size(), 2u);
  EXPECT_TRUE(warned(scene, "instances", 1));
}

// Not required of every scene, but of each that has no surprise: a picture that is opaque where the material might not
// be, say.
TEST(PackFeatures, AreForeseenBeforeImagesAreDecoded) {
  int foreseen = 0, scenes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(WAVEPATH_SOURCE_DIR "/scenes")) {
    if (entry.path().extension() != ".gltf" && entry.path().extension() != ".glb") continue;
    SCOPED_TRACE(entry.path());
    for (const std::uint32_t direct : {gpu::kDirectMis, gpu::kDirectNee, gpu::kDirectBsdf}) {
      std::uint32_t expected = 0;
      Scene scene = load_gltf(entry.path(), {}, [&](Scene& described) {
        described.environment.radiance = glm::vec3(1.0f);
        EXPECT_TRUE(described.images.empty());
        expected = expected_features(described, direct);
      });
      const std::uint32_t found = pack(scene, {.direct = direct}).features;
      EXPECT_EQ(found & ~expected, 0u) << "bits that kernels would have to be compiled again for";
      foreseen += expected == found;
      ++scenes;
    }
  }
  EXPECT_GE(foreseen, scenes * 9 / 10);
}

TEST(PackTangent, RoundTripsToAFewHundredthsOfADegree) {
  std::mt19937 random(2);
  std::normal_distribution<float> normal;
  std::vector<glm::vec3> directions{{0, 0, 1}, {0, 0, -1}, {-1e-9f, -1e-9f, -1}, {1, 0, 0}, {0, -1, 0}};
  for (int i = 0; i < 1000; ++i)
    directions.push_back(glm::normalize(glm::vec3(normal(random), normal(random), normal(random))));
  for (const glm::vec3& d : directions)
    for (const float handedness : {1.0f, -1.0f}) {
      const std::uint32_t bits = std::bit_cast<std::uint32_t>(pack_tangent({d, handedness}));
      EXPECT_NE(bits, 0u);
      glm::vec3 q{static_cast<float>(bits >> 16) / 65535.0f * 2.0f - 1.0f,
                  static_cast<float>(bits >> 1 & 32767u) / 32767.0f * 2.0f - 1.0f, 0.0f};
      q.z = 1.0f - std::abs(q.x) - std::abs(q.y);
      if (q.z < 0.0f) {
        const glm::vec2 xy{q.x, q.y};
        q.x = (1.0f - std::abs(xy.y)) * (xy.x < 0.0f ? -1.0f : 1.0f);
        q.y = (1.0f - std::abs(xy.x)) * (xy.y < 0.0f ? -1.0f : 1.0f);
      }
      EXPECT_LT(glm::length(glm::normalize(q) - d), 3e-4f);
      EXPECT_EQ((bits & 1u) != 0u, handedness < 0.0f);
    }
  EXPECT_EQ(std::bit_cast<std::uint32_t>(pack_tangent(glm::vec4(0.0f))), 0u);
}

} // namespace
} // namespace wavepath
