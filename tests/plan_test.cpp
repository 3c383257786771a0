// The plan of a scene's bytes against what packing yields, on scenes built here and on real ones.
#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/base/error.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/pack.h"
#include "host/scene/pack/plan.h"
#include "kernels/base/scene_types.h"
#include "tests/scene_builder.h"

namespace wavepath {
namespace {

// Parts of textured emitters follow from their texels, which a plan does not read.
constexpr std::uint64_t kMostPartBytes = (std::uint64_t{1} << 20) + (1 << 18);

template <typename Item>
std::uint64_t bytes(const std::vector<Item>& items) {
  return items.size() * sizeof(Item);
}

std::uint64_t packed_bytes(const PackedScene& p) {
  return bytes(p.nodes) + bytes(p.triangles) + bytes(p.instances) + bytes(p.triangle_vertices) +
         bytes(p.vertex_normals) + bytes(p.vertex_uvs) + bytes(p.vertex_colors) + bytes(p.texels) + bytes(p.lights) +
         bytes(p.light_tree) + bytes(p.environment) + bytes(p.environment_ends);
}

// The kernels index with what they find here; every index must have something to point at.
void expect_indices_in_range(const PackedScene& p) {
  const std::size_t vertex_count = std::max({p.vertex_normals.size(), p.vertex_uvs.size(), p.vertex_colors.size()});
  for (const gpu::Triangle& t : p.triangles) ASSERT_LT(t.surface & gpu::kTriangleMaterialMask, p.materials.size());
  for (const glm::uvec4& v : p.triangle_vertices) ASSERT_LT(std::max({v.x, v.y, v.z}), vertex_count);
  for (const gpu::Material& m : p.materials)
    for (const std::uint32_t texture :
         {m.base_color_texture, m.metallic_roughness_texture, m.normal_texture, m.emission_texture, m.specular_texture,
          m.specular_color_texture, m.transmission_texture})
      ASSERT_TRUE(texture == gpu::kNone || texture < p.textures.size());
  for (const gpu::Texture& t : p.textures) {
    const std::uint64_t words = std::uint64_t{t.width} * t.height * (t.flags & gpu::kTextureFloat ? 4 : 1);
    ASSERT_LE(t.first_texel + words, p.texels.size());
  }
  for (const gpu::Light& light : p.lights) {
    if (light.kind == gpu::kLightTriangle) {
      ASSERT_LT(light.triangle, p.triangles.size());
      ASSERT_LT(p.triangles[light.triangle].light, p.lights.size());
      ASSERT_EQ(p.triangles[light.triangle].id, light.triangle_id);
      ASSERT_TRUE(p.root_is_top ? light.instance < p.instances.size() : light.instance == 0);
    }
  }
}

TEST(ScenePlan, CountsWhatIsShown) {
  Scene scene = triangle_scene();
  add_instance(scene, 0, glm::translate(glm::dmat4(1.0), glm::dvec3(2.0)));
  add_instance(scene, add_mesh(scene, kUnitTriangle));
  add_mesh(scene, kUnitTriangle); // not shown
  scene.meshes[0].colors.assign(3, glm::vec4(1.0f));
  scene.environment.radiance = glm::vec3(1.0f);
  scene.environment.width = 8;
  scene.environment.height = 4;
  scene.environment.map.assign(32, glm::vec3(1.0f));
  const ScenePlan p = plan(scene);
  EXPECT_EQ(p.triangles_stored, 2u);
  EXPECT_EQ(p.triangles_seen, 3u);
  EXPECT_EQ(p.instances, 3u);
  EXPECT_EQ(p.triangle_bytes, 2u * (48 + 16));
  EXPECT_EQ(p.vertex_bytes, 6u * 16);
  EXPECT_EQ(p.environment_bytes, 32u * 20 + 4 * 4 + (1 + 4 * 2) * 4); // with the cuts of rows and columns
  EXPECT_EQ(p.largest_buffer, 32u * 16);
}

TEST(ScenePlan, TellsOfSmoothSurfacesInUse) {
  Scene scene = triangle_scene();
  scene.materials[0].specular = scene.materials[0].roughness = 1.0f;
  scene.materials.push_back(scene.materials[0]); // not in use
  scene.materials[1].roughness = 0.0f;
  EXPECT_FALSE(plan(scene).smooth_surfaces);
  scene.materials[0].roughness = 0.0f;
  EXPECT_TRUE(plan(scene).smooth_surfaces);
}

TEST(ScenePlan, CountsTexelsOnceAnImage) {
  Scene scene = triangle_scene();
  scene.images.push_back({"bytes", 16, 16, std::vector<std::uint8_t>(1024, 255), {}});
  scene.images.push_back({"floats", 4, 4, {}, std::vector<float>(64, 1.0f)});
  scene.images.push_back({"unused", 4, 4, std::vector<std::uint8_t>(64, 255), {}});
  scene.materials[0].base_color_texture.image = scene.materials[0].specular_texture.image = 0;
  scene.materials[0].normal_texture.image = 1;
  EXPECT_EQ(plan(scene).texel_bytes, 16u * 16 * 4 + 4u * 4 * 16);
}

TEST(ScenePlan, FitsManyInstances) {
  Scene scene = triangle_scene();
  for (int i = 0; i < 2000; ++i)
    add_instance(scene, 0, glm::translate(glm::dmat4(1.0), glm::dvec3(i % 50, i / 50, i % 7)));
  const double planned = static_cast<double>(plan(scene).total());
  const double real = static_cast<double>(packed_bytes(pack(scene)));
  EXPECT_GT(planned, 0.9 * real);
  EXPECT_LT(planned, 1.3 * real);
}

TEST(ScenePlan, FitsRealScenes) {
  const std::filesystem::path folder = std::filesystem::path(WAVEPATH_SOURCE_DIR) / ".." / "shared" / "scenes";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  int packed_count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::filesystem::path& file = entry.path();
    if (file.extension() != ".gltf" && file.extension() != ".glb") continue;
    SCOPED_TRACE(file.string());
    Scene scene;
    try {
      scene = load_gltf(file);
    } catch (const Error&) {
      continue; // what cannot be loaded is the loader's test
    }
    const ScenePlan p = plan(scene);
    const PackedScene packed = pack(scene);
    ++packed_count;
    expect_indices_in_range(packed);
    const std::uint64_t dropped = packed.root_is_top ? 0 : packed.dropped_triangles;
    EXPECT_EQ(packed.triangles.size() + dropped + packed.alpha.holes, p.triangles_stored);
    const double real = static_cast<double>(packed_bytes(packed)), planned = static_cast<double>(p.total());
    EXPECT_GT(planned, 0.9 * real);
    EXPECT_LT(planned, 1.3 * real + 1000.0); // small change aside
    EXPECT_GE(p.largest_buffer, bytes(packed.triangles));
    EXPECT_LE(bytes(packed.light_parts), kMostPartBytes);
  }
  EXPECT_GT(packed_count, 50);
}

} // namespace
} // namespace wavepath
