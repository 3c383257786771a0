// glTF import, feature by feature: containers, geometry, nodes, cameras, lights. Each test builds its own tiny
// file.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/gltf_checks.h"

namespace wavepath {
namespace {

using nlohmann::json;
using test::expect_near;
using test::GltfBuilder;
using test::load;
using test::TempFolder;
using test::warning_count;

// --- containers ---

TEST(Gltf, TheSameFromEveryContainer) {
  TempFolder folder;
  const GltfBuilder builder = GltfBuilder::triangle();
  folder.write("b\xc3\xbc\x66 1.bin", builder.bytes);
  folder.write("50%20.bin", builder.bytes);
  for (const auto& path : {folder.write("embedded.gltf", builder.json()), folder.write("binary.glb", builder.glb()),
                           folder.write("spaces.gltf", builder.json("b\xc3\xbc\x66 1.bin")),
                           folder.write("encoded.gltf", builder.json("b%C3%bcf%201.bin")),
                           folder.write("literal.gltf", builder.json("50%20.bin")),
                           folder.write("marked.gltf", "\xef\xbb\xbf" + builder.json())}) {
    const Scene scene = load_gltf(path);
    ASSERT_EQ(scene.meshes.size(), 1u) << path;
    EXPECT_EQ(scene.meshes[0].positions[1], glm::vec3(1, 0, 0)) << path;
    EXPECT_EQ(scene.instances.size(), 1u);
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.path, path.string());
  }
}

TEST(Gltf, VersionsThatAReaderOf20MayRead) {
  for (const json& asset :
       {json{{"version", "2.0"}, {"minVersion", "2.0"}}, json{{"version", "2.10"}},
        json{{"version", "2.1"}, {"minVersion", "2.0"}}, json{{"version", "3.0"}, {"minVersion", "2.0"}}}) {
    GltfBuilder b = GltfBuilder::triangle();
    b.root["asset"] = asset;
    EXPECT_EQ(load(b).meshes.size(), 1u) << asset;
  }
}

TEST(Gltf, EmptySceneLoads) {
  const Scene scene = load(GltfBuilder{});
  EXPECT_TRUE(scene.meshes.empty() && scene.instances.empty() && scene.materials.empty());
}

// --- accessors ---

TEST(Gltf, ComponentTypesAndNormalization) {
  GltfBuilder b;
  b.root["extensionsUsed"] = b.root["extensionsRequired"] = {"KHR_mesh_quantization"};
  const auto add = [&](int position) { b.mesh_node({{"POSITION", position}}); };
  add(b.accessor<std::int8_t>("VEC3", test::kByte, {-128, 127, 0, 1, 2, 3, 4, 5, 7}, true));
  add(b.accessor<std::uint8_t>("VEC3", test::kUbyte, {255, 51, 0, 1, 2, 3, 4, 5, 7}, true));
  add(b.accessor<std::int16_t>("VEC3", test::kShort, {-32768, 32767, 16384, 1, 2, 3, 4, 5, 7}, true));
  add(b.accessor<std::uint16_t>("VEC3", test::kUshort, {65535, 13107, 0, 1, 2, 3, 4, 5, 7}, true));
  add(b.accessor<std::int8_t>("VEC3", test::kByte, {-128, 127, 0, 1, 2, 3, 4, 5, 7}));
  add(b.accessor<std::uint16_t>("VEC3", test::kUshort, {65535, 7, 0, 1, 2, 3, 4, 5, 7}));
  add(b.accessor<std::uint32_t>("VEC3", test::kUint, {70000, 7, 0, 1, 2, 3, 4, 5, 7}));
  const Scene scene = load(b);
  const glm::vec3 expected[] = {{-1, 1, 0},    {1, 0.2, 0},  {-1, 1, 16384.0 / 32767.0}, {1, 0.2, 0}, {-128, 127, 0},
                                {65535, 7, 0}, {70000, 7, 0}};
  ASSERT_EQ(scene.meshes.size(), std::size(expected));
  for (std::size_t i = 0; i < std::size(expected); ++i) expect_near(scene.meshes[i].positions[0], expected[i], 1e-7);
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(Gltf, StridedAndOffsetAccessors) {
  GltfBuilder b;
  // Interleaved: position, normal.
  const int view = b.view(std::vector<float>{0, 0, 0, 0, 0, 2, 1, 0, 0, 0, 3, 0, 0, 1, 0, 4, 0, 0}, 24);
  const int position =
      b.add("accessors", {{"bufferView", view}, {"componentType", 5126}, {"type", "VEC3"}, {"count", 3}});
  const int normal = b.add(
      "accessors", {{"bufferView", view}, {"byteOffset", 12}, {"componentType", 5126}, {"type", "VEC3"}, {"count", 3}});
  b.mesh_node({{"POSITION", position}, {"NORMAL", normal}});
  const Scene scene = load(b);
  EXPECT_EQ(scene.meshes[0].positions[2], glm::vec3(0, 1, 0));
  EXPECT_EQ(scene.meshes[0].normals[0], glm::vec3(0, 0, 1)); // made unit length
  EXPECT_EQ(scene.meshes[0].normals[2], glm::vec3(1, 0, 0));
  EXPECT_TRUE(scene.meshes[0].primitives[0].has_normals);
}

TEST(Gltf, SparseAccessors) {
  GltfBuilder b = GltfBuilder::triangle();
  const int indices = b.view(std::vector<std::uint8_t>{2, 0}), values = b.view(std::vector<float>{5, 5, 5, 6, 6, 6});
  const json sparse = {{"count", 2},
                       {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                       {"values", {{"bufferView", values}}}};
  json with_base = b.root["accessors"][0];
  with_base["sparse"] = sparse;
  b.mesh_node({{"POSITION", b.add("accessors", with_base)}});
  with_base.erase("bufferView");
  b.mesh_node({{"POSITION", b.add("accessors", with_base)}});
  const Scene scene = load(b);
  ASSERT_EQ(scene.meshes.size(), 3u);
  EXPECT_EQ(scene.meshes[1].positions, (std::vector<glm::vec3>{{6, 6, 6}, {1, 0, 0}, {5, 5, 5}}));
  EXPECT_EQ(scene.meshes[2].positions, (std::vector<glm::vec3>{{6, 6, 6}, {0, 0, 0}, {5, 5, 5}}));
}

TEST(Gltf, IndicesOfEveryTypeKeepOnlyUsedVertices) {
  GltfBuilder b;
  const int position = b.floats("VEC3", {9, 9, 9, 0, 0, 0, 1, 0, 0, 8, 8, 8, 0, 1, 0});
  const int indices[] = {b.accessor<std::uint8_t>("SCALAR", test::kUbyte, {4, 1, 2}),
                         b.accessor<std::uint16_t>("SCALAR", test::kUshort, {4, 1, 2}),
                         b.accessor<std::uint32_t>("SCALAR", test::kUint, {4, 1, 2})};
  for (const int accessor : indices) b.mesh_node({{"POSITION", position}}, {{"indices", accessor}});
  const Scene scene = load(b);
  ASSERT_EQ(scene.meshes.size(), 3u);
  for (const Mesh& mesh : scene.meshes) {
    EXPECT_EQ(mesh.positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{2, 0, 1}));
  }
}

// --- primitives ---

TEST(Gltf, StripsFansPointsAndLines) {
  GltfBuilder b;
  const int position = b.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 2, 0});
  for (const int mode : {0, 1, 2, 3, 5, 6}) b.mesh_node({{"POSITION", position}}, {{"mode", mode}});
  const Scene scene = load(b);
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.meshes[scene.instances[0].mesh].indices, (std::vector<std::uint32_t>{0, 1, 2, 1, 3, 2, 2, 3, 4}));
  EXPECT_EQ(scene.meshes[scene.instances[1].mesh].indices, (std::vector<std::uint32_t>{1, 2, 0, 2, 3, 0, 3, 4, 0}));
  EXPECT_EQ(warning_count(scene, "points or lines"), 4u);
}

TEST(Gltf, PrimitivesOfOneMeshAreJoined) {
  GltfBuilder b = GltfBuilder::triangle();
  json second = b.primitive();
  b.primitive()["attributes"]["COLOR_0"] =
      b.accessor<std::uint8_t>("VEC3", test::kUbyte, {255, 0, 0, 0, 255, 0, 0, 0, 51}, true);
  second["material"] = b.add("materials", {{"name", "second"}});
  second["attributes"]["NORMAL"] = b.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
  b.root["meshes"][0]["primitives"].push_back(second);
  const Scene scene = load(b);
  const Mesh& mesh = scene.meshes[0];
  ASSERT_EQ(mesh.primitives.size(), 2u);
  EXPECT_EQ(mesh.primitives[1].first_index, 3u);
  EXPECT_EQ(mesh.primitives[1].index_count, 3u);
  EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}));
  EXPECT_FALSE(mesh.primitives[0].has_normals);
  EXPECT_TRUE(mesh.primitives[1].has_normals);
  ASSERT_EQ(mesh.normals.size(), 6u);
  EXPECT_EQ(mesh.normals[0], glm::vec3(0)); // flat
  EXPECT_EQ(mesh.normals[5], glm::vec3(0, 0, 1));
  ASSERT_EQ(mesh.colors.size(), 6u);
  EXPECT_EQ(mesh.colors[2], glm::vec4(0, 0, 51 / 255.0f, 1));
  EXPECT_EQ(mesh.colors[3], glm::vec4(1));                          // what the second primitive lacks
  EXPECT_EQ(scene.materials[mesh.primitives[0].material].name, ""); // the default one
  EXPECT_EQ(scene.materials[mesh.primitives[1].material].name, "second");
}

TEST(Gltf, ColorsOfFloatsAndShortsWithAlpha) {
  GltfBuilder b = GltfBuilder::triangle();
  b.primitive()["attributes"]["COLOR_0"] = b.floats("VEC4", {0.25, 0.5, 1, 0.75, 0, 0, 0, 0, 0, 0, 0, 0});
  b.mesh_node({{"POSITION", 0},
               {"COLOR_0", b.accessor<std::uint16_t>("VEC4", test::kUshort,
                                                     {65535, 0, 13107, 65535, 0, 0, 0, 0, 0, 0, 0, 0}, true)}});
  const Scene scene = load(b);
  EXPECT_EQ(scene.meshes[0].colors[0], glm::vec4(0.25, 0.5, 1, 0.75));
  EXPECT_EQ(scene.meshes[1].colors[0], glm::vec4(1, 0, 0.2f, 1));
}

TEST(Gltf, ColorsAreClamped) {
  GltfBuilder b = GltfBuilder::triangle();
  b.primitive()["attributes"]["COLOR_0"] = b.floats("VEC4", {2, -1, 0.5, 3, 0, 0, 0, 0, 1, 1, 1, -0.25});
  const Scene scene = load(b);
  EXPECT_EQ(scene.meshes[0].colors[0], glm::vec4(1, 0, 0.5, 1));
  EXPECT_EQ(scene.meshes[0].colors[2], glm::vec4(1, 1, 1, 0));
}

TEST(Gltf, NormalsWithoutLengthAreRepaired) {
  GltfBuilder b = GltfBuilder::triangle();
  b.primitive()["attributes"]["NORMAL"] = b.floats("VEC3", {0, 0, 0, NAN, 0, 1, 3, 0, 4});
  const Scene scene = load(b);
  EXPECT_EQ(scene.meshes[0].normals[0], glm::vec3(0, 0, 1));
  EXPECT_EQ(scene.meshes[0].normals[1], glm::vec3(0, 0, 1));
  expect_near(scene.meshes[0].normals[2], {0.6, 0, 0.8}, 1e-7);
  EXPECT_EQ(warning_count(scene, "normal"), 2u);
}

TEST(Gltf, NonFinitePositionsAreKeptForThePackerToCount) {
  GltfBuilder b;
  b.mesh_node({{"POSITION", b.floats("VEC3", {0, 0, 0, INFINITY, 0, 0, 0, NAN, 0})}});
  const Scene scene = load(b);
  EXPECT_TRUE(std::isinf(scene.meshes[0].positions[1].x) && std::isnan(scene.meshes[0].positions[2].y));
}

// --- nodes ---

TEST(Gltf, TransformsAreComposedInDouble) {
  GltfBuilder b = GltfBuilder::triangle();
  const double h = std::sqrt(0.5);
  b.root["nodes"][0]["translation"] = {1e-9, 2, 3};
  b.root["nodes"][0]["rotation"] = {0, 0, h, h}; // +90 degrees about z
  b.root["nodes"][0]["scale"] = {2, 3, 4};
  b.add("nodes", {{"children", {0}}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 1000000, 0, 0, 1}}});
  const Scene scene = load(b);
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.node_parents, (std::vector<std::uint32_t>{1, kNoIndex}));
  const glm::dmat4& m = scene.instances[0].world_from_object;
  expect_near(m * glm::dvec4(1, 0, 0, 1), {1000000 + 1e-9, 4, -3}, 1e-9);
  expect_near(m * glm::dvec4(0, 1, 0, 0), {-3, 0, 0}, 1e-12);
  EXPECT_NEAR(m[3].x - 1e6, 1e-9, 2e-10);        // a float would have lost it
  EXPECT_LT(glm::determinant(glm::dmat3(m)), 0); // mirrored
}

TEST(Gltf, RepeatedMeshesAreInstances) {
  GltfBuilder b = GltfBuilder::triangle();
  for (int i = 1; i < 4; ++i) b.add("nodes", {{"mesh", 0}, {"translation", {i, 0, 0}}});
  const Scene scene = load(b);
  EXPECT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 4u);
  EXPECT_EQ(scene.instances[3].world_from_object[3].x, 3.0);
}

TEST(Gltf, ScenesAreChosenByDefaultIndexAndName) {
  GltfBuilder b = GltfBuilder::triangle();
  b.mesh_node({{"POSITION", b.floats("VEC3", {0, 0, 0, 7, 0, 0, 0, 1, 0})}});
  b.add("scenes", {{"name", "first"}, {"nodes", {0}}});
  b.add("scenes", {{"name", "other"}, {"nodes", {1}}});
  const auto width = [&](const std::string& name) { return load(b, {name, "", 0.0}).meshes.at(0).positions[1].x; };
  EXPECT_EQ(width(""), 1.0f);
  EXPECT_EQ(width("1"), 7.0f);
  EXPECT_EQ(width("other"), 7.0f);
  b.root["scene"] = 1;
  EXPECT_EQ(width(""), 7.0f);
  EXPECT_EQ(width("first"), 1.0f);
  EXPECT_EQ(load(b).meshes.size(), 1u); // the mesh of the other scene is not read
}

TEST(Gltf, Cameras) {
  GltfBuilder b;
  b.add("cameras", {{"name", "eye"},
                    {"type", "perspective"},
                    {"perspective", {{"yfov", 0.5}, {"aspectRatio", 2.0}, {"znear", 0.1}}}});
  b.add("cameras", {{"type", "orthographic"}, {"orthographic", {{"xmag", 3}, {"ymag", 4}, {"znear", 0}, {"zfar", 9}}}});
  b.add("nodes", {{"camera", 0}, {"translation", {1, 2, 3}}});
  b.add("nodes", {{"camera", 1}, {"name", "plan"}});
  const Scene scene = load(b);
  ASSERT_EQ(scene.cameras.size(), 2u);
  EXPECT_EQ(scene.cameras[0].name, "eye");
  EXPECT_FALSE(scene.cameras[0].orthographic);
  EXPECT_EQ(scene.cameras[0].yfov, 0.5);
  EXPECT_EQ(scene.cameras[0].aspect, 2.0);
  expect_near(scene.cameras[0].world_from_camera[3], {1, 2, 3});
  EXPECT_TRUE(scene.cameras[1].orthographic);
  EXPECT_EQ(scene.cameras[1].name, "plan");
  EXPECT_EQ(scene.cameras[1].xmag, 3.0);
  EXPECT_EQ(scene.cameras[1].ymag, 4.0);
}

TEST(Gltf, PunctualLights) {
  GltfBuilder b;
  const double h = std::sqrt(0.5);
  b.root["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 10}},
      {{"type", "spot"}, {"range", 7}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.4}}}},
      {{"type", "directional"}, {"intensity", 3}, {"range", 7}, {"name", "sun"}}};
  for (int i = 0; i < 3; ++i)
    b.add("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}, {"translation", {0, i, 0}}});
  b.root["nodes"][2]["rotation"] = {-h, 0, 0, h}; // from -z down to -y
  b.root["nodes"][2]["scale"] = {5, 5, 5};
  const Scene scene = load(b);
  ASSERT_EQ(scene.lights.size(), 3u);
  EXPECT_EQ(scene.lights[0].kind, LightKind::point);
  EXPECT_EQ(scene.lights[0].intensity, glm::vec3(10, 5, 0));
  EXPECT_EQ(scene.lights[1].kind, LightKind::spot);
  EXPECT_EQ(scene.lights[1].inner_cone, 0.2);
  EXPECT_EQ(scene.lights[1].outer_cone, 0.4);
  EXPECT_EQ(scene.lights[0].range, 0.0);
  EXPECT_EQ(scene.lights[1].range, 7.0);
  EXPECT_EQ(scene.lights[2].range, 0.0) << "suns have none";
  expect_near(scene.lights[1].position, {0, 1, 0});
  EXPECT_EQ(scene.lights[2].kind, LightKind::directional);
  EXPECT_EQ(scene.lights[2].name, "sun");
  expect_near(scene.lights[2].direction, {0, -1, 0}, 1e-12);
}

// Extensions that change no picture are silent; drafts and others are named as what they are.
TEST(Gltf, ExtensionsAreSilentOrNamed) {
  GltfBuilder b = GltfBuilder::triangle();
  b.root["extensionsUsed"] = {"KHR_interactivity", "KHR_node_hoverability", "KHR_node_selectability",
                              "KHR_xmp_json_ld"};
  b.root["extensionsRequired"] = b.root["extensionsUsed"];
  EXPECT_TRUE(test::load(b).warnings.empty());
  b.root.erase("extensionsRequired");
  for (const char* name : {"KHR_materials_retroreflection (a draft)", "KHR_accessor_float64 (numbers of 64 bits)",
                           "EXT_texture_astc (textures of ASTC blocks)", "EXT_mesh_primitive_restart (indices",
                           "KHR_gaussian_splatting (splats"}) {
    const std::string text = name;
    b.root["extensionsUsed"] = {text.substr(0, text.find(' '))};
    EXPECT_EQ(test::warning_count(test::load(b), "not supported, ignored: " + text), 1u) << name;
  }
}

} // namespace
} // namespace wavepath
