// Whatever of a scene changes a picture changes its hash.
#include <functional>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "host/base/overloaded.h"
#include "host/scene/scene_hash.h"

namespace wavepath {
namespace {

// One of everything; all textures of the material hold the image.
Scene full_scene() {
  Scene scene;
  scene.images.push_back({"image", 1, 2, {1, 2, 3, 4, 5, 6, 7, 8}, {}});
  scene.images.push_back({"deep", 1, 1, {}, {0.1f, 0.2f, 0.3f, 0.4f}});
  Material material;
  visit_material_fields(
      Overloaded{[](const auto&) {}, [&](const MaterialTexture& row) { (material.*row.field).image = 0; }});
  scene.materials.push_back(material);
  Mesh mesh;
  mesh.positions = mesh.normals = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.tangents = mesh.colors = std::vector<glm::vec4>(3, glm::vec4(1.0f));
  mesh.uvs[0] = mesh.uvs[1] = std::vector<glm::vec2>(3, glm::vec2(0.0f));
  mesh.indices = {0, 1, 2};
  mesh.primitives = {{0, 3, 0, true}};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({});
  scene.lights.push_back({});
  scene.environment.map = {glm::vec3(1.0f)};
  scene.environment.width = scene.environment.height = 1;
  return scene;
}

void change(float& value) { value += 0.125f; }
void change(double& value) { value += 0.125; }
void change(bool& value) { value = !value; }
void change(std::uint8_t& value) { ++value; }
void change(std::uint32_t& value) { ++value; }
void change(AlphaMode& value) { value = value == AlphaMode::mask ? AlphaMode::blend : AlphaMode::mask; }
void change(Wrap& value) { value = Wrap::mirror; }
void change(LightKind& value) { value = LightKind::spot; }

// Changes one field, or one component of it, at a time, and expects a hash that no other change has given.
class SceneHash : public testing::Test {
protected:
  template <class T>
  void expect_seen(const std::string& what, T& value) {
    const T before = value;
    change(value);
    EXPECT_TRUE(seen_.insert(hash_scene(scene_)).second) << what;
    value = before;
  }
  template <int N, class T>
  void expect_seen(const std::string& what, glm::vec<N, T>& value) {
    for (int i = 0; i < N; ++i) expect_seen(what + "[" + std::to_string(i) + "]", value[i]);
  }
  template <int N, class T>
  void expect_seen(const std::string& what, glm::mat<N, N, T>& value) {
    for (int i = 0; i < N; ++i) expect_seen(what + "[" + std::to_string(i) + "]", value[i]);
  }
  void expect_seen(const std::string& what, TextureSlot& slot) {
    int index = 0;
    visit_texture_slot(slot, [&](auto& value) { expect_seen(what + " property " + std::to_string(index++), value); });
  }
  template <class T>
  void expect_seen(const std::string& what, std::vector<T>& values) {
    for (T& value : values) expect_seen(what, value);
    std::vector<T> before = values;
    values.pop_back();
    EXPECT_TRUE(seen_.insert(hash_scene(scene_)).second) << what << " is one shorter";
    values = before;
  }

  Scene scene_ = full_scene();
  std::set<std::uint64_t> seen_ = {hash_scene(scene_)};
};

TEST_F(SceneHash, SeesEveryFieldOfAMaterial) {
  visit_material_fields([&](const auto& row) { expect_seen(row.name, scene_.materials[0].*row.field); });
  EXPECT_GT(seen_.size(), 80u); // 11 factors, 4 choices, 7 textures of 8 properties, by component
}

TEST_F(SceneHash, SeesWhichSlotATextureIsIn) {
  visit_material_fields(Overloaded{[](const auto&) {},
                                   [&](const MaterialTexture& row) {
                                     TextureSlot taken;
                                     std::swap(taken, scene_.materials[0].*row.field);
                                     EXPECT_TRUE(seen_.insert(hash_scene(scene_)).second) << row.name;
                                     std::swap(taken, scene_.materials[0].*row.field);
                                   }});
}

TEST_F(SceneHash, SeesGeometry) {
  Mesh& mesh = scene_.meshes[0];
  expect_seen("positions", mesh.positions);
  expect_seen("normals", mesh.normals);
  expect_seen("tangents", mesh.tangents);
  for (std::vector<glm::vec4>& tangents : mesh.layer_tangents) {
    tangents = mesh.tangents;
    expect_seen("layer_tangents", tangents);
  }
  expect_seen("uvs[0]", mesh.uvs[0]);
  expect_seen("uvs[1]", mesh.uvs[1]);
  expect_seen("colors", mesh.colors);
  expect_seen("indices", mesh.indices);
  expect_seen("first_index", mesh.primitives[0].first_index);
  expect_seen("index_count", mesh.primitives[0].index_count);
  expect_seen("material", mesh.primitives[0].material);
  expect_seen("has_normals", mesh.primitives[0].has_normals);
  expect_seen("instance.mesh", scene_.instances[0].mesh);
  expect_seen("world_from_object", scene_.instances[0].world_from_object);
}

TEST_F(SceneHash, SeesImagesLightsAndEnvironment) {
  expect_seen("width", scene_.images[0].width);
  expect_seen("height", scene_.images[0].height);
  expect_seen("bytes", scene_.images[0].bytes);
  expect_seen("floats", scene_.images[1].floats);
  PunctualLight& light = scene_.lights[0];
  expect_seen("kind", light.kind);
  expect_seen("intensity", light.intensity);
  expect_seen("position", light.position);
  expect_seen("direction", light.direction);
  expect_seen("inner_cone", light.inner_cone);
  expect_seen("outer_cone", light.outer_cone);
  Environment& environment = scene_.environment;
  expect_seen("radiance", environment.radiance);
  expect_seen("environment width", environment.width);
  expect_seen("environment height", environment.height);
  expect_seen("map", environment.map);
  expect_seen("rotation", environment.rotation);
}

TEST_F(SceneHash, IgnoresNamesAndWhereTheFileLies) {
  const std::uint64_t before = hash_scene(scene_);
  scene_.path = "elsewhere.glb";
  scene_.materials[0].name = scene_.meshes[0].name = scene_.images[0].name = scene_.lights[0].name = "renamed";
  scene_.warnings.add("something");
  EXPECT_EQ(hash_scene(scene_), before);
}

TEST_F(SceneHash, SeesWhereOneListEndsAndTheNextBegins) {
  Mesh& mesh = scene_.meshes[0];
  mesh.tangents.clear(); // the same bytes in another array
  const std::uint64_t as_colors = hash_scene(scene_);
  std::swap(mesh.tangents, mesh.colors);
  EXPECT_NE(hash_scene(scene_), as_colors);
}

} // namespace
} // namespace wavepath
