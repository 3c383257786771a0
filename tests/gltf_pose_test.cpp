// glTF import: morph targets, skins and animations.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/gltf_checks.h"

namespace wavepath {
namespace {

using nlohmann::json;
using test::expect_near;
using test::GltfBuilder;
using test::load;

TEST(GltfPose, MorphTargetsAtMeshAndNodeWeights) {
  GltfBuilder b = GltfBuilder::triangle();
  b.primitive()["attributes"]["NORMAL"] = b.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
  b.primitive()["targets"] = {{{"POSITION", b.floats("VEC3", {0, 0, 2, 0, 0, 0, 0, 0, 0})},
                               {"NORMAL", b.floats("VEC3", {4, 0, -1, 0, 0, 0, 0, 0, 0})}},
                              {{"POSITION", b.floats("VEC3", {0, 0, 0, 0, 8, 0, 0, 0, 0})}}};
  b.root["meshes"][0]["weights"] = {0.5, 0.25};
  b.add("nodes", {{"mesh", 0}, {"weights", {1, 0}}});
  b.add("nodes", {{"mesh", 0}});
  const Scene scene = load(b);
  ASSERT_EQ(scene.meshes.size(), 2u); // two sets of weights; nodes 0 and 2 share one
  EXPECT_EQ(scene.instances[2].mesh, scene.instances[0].mesh);
  EXPECT_EQ(scene.meshes[0].positions[0], glm::vec3(0, 0, 1));
  EXPECT_EQ(scene.meshes[0].positions[1], glm::vec3(1, 2, 0));
  EXPECT_EQ(scene.meshes[1].positions[0], glm::vec3(0, 0, 2));
  EXPECT_EQ(scene.meshes[1].positions[1], glm::vec3(1, 0, 0));
  EXPECT_EQ(scene.meshes[1].normals[0], glm::vec3(1, 0, 0));
}

// What a target moves besides the surface, of every type that the specification allows.
TEST(GltfPose, MorphTargetsMoveTextureCoordinatesAndColors) {
  GltfBuilder b = GltfBuilder::triangle();
  json& primitive = b.primitive();
  primitive["attributes"]["TEXCOORD_0"] = b.floats("VEC2", {0, 0, 1, 0, 0, 1});
  primitive["attributes"]["TEXCOORD_1"] = b.floats("VEC2", {0, 0, 2, 0, 0, 2});
  primitive["attributes"]["COLOR_0"] = b.floats("VEC4", {0.5, 0.5, 0.5, 1, 0.5, 0.5, 0.5, 1, 0.25, 0, 1, 0.5});
  primitive["targets"] = {
      {{"TEXCOORD_0", b.floats("VEC2", {0, 0, 1, 2, 0, 0})},
       {"COLOR_0", b.floats("VEC4", {0.5, -0.25, 4, 0, -9, 0, 0, -0.5, 0, 0, 0, 0})}},
      {{"TEXCOORD_1", b.accessor<std::int8_t>("VEC2", test::kByte, {0, 0, 0, 0, 127, -127}, true)},
       {"COLOR_0", b.floats("VEC3", {0, 0, 0, 0, 0, 0, 0.5, 0.5, -1})}},
      {{"COLOR_0", b.accessor<std::int16_t>("VEC4", test::kShort, {0, 0, 0, 0, 0, 32767, 0, 0, 0, 0, 0, 0}, true)}},
      {{"TEXCOORD_0", b.floats("VEC2", {9, 9, 9, 9, 9, 9})}}}; // weighs nothing
  b.root["meshes"][0]["weights"] = {0.5, 1, -0.25, 0};
  b.add("images", {{"bufferView", b.view(std::string(test::kPng, sizeof(test::kPng) - 1))}});
  b.add("textures", {{"source", 0}});
  primitive["material"] =
      b.add("materials",
            {{"pbrMetallicRoughness",
              {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 0}, {"texCoord", 1}}}}}});
  const Mesh mesh = load(b).meshes.at(0);
  EXPECT_EQ(mesh.uvs[0], (std::vector<glm::vec2>{{0, 0}, {1.5, 1}, {0, 1}}));
  EXPECT_EQ(mesh.uvs[1], (std::vector<glm::vec2>{{0, 0}, {2, 0}, {1, 1}}));
  // Clamped when all targets are in.
  EXPECT_EQ(mesh.colors, (std::vector<glm::vec4>{{0.75, 0.375, 1, 1}, {0, 0.25, 0.5, 0.75}, {0.75, 0.5, 0, 0.5}}));
}

// The tangents of a normal map follow the morphed coordinates.
TEST(GltfPose, MorphedTextureCoordinatesTurnTangents) {
  GltfBuilder b = GltfBuilder::triangle();
  json& primitive = b.primitive();
  primitive["attributes"]["NORMAL"] = b.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
  primitive["attributes"]["TEXCOORD_0"] = b.floats("VEC2", {0, 0, 1, 0, 0, 1});
  primitive["targets"] = {{{"TEXCOORD_0", b.floats("VEC2", {0, 0, -1, 1, 1, -1})}}}; // u and v change places
  b.root["meshes"][0]["weights"] = {1};
  b.add("images", {{"bufferView", b.view(std::string(test::kPng, sizeof(test::kPng) - 1))}});
  b.add("textures", {{"source", 0}});
  primitive["material"] = b.add("materials", {{"normalTexture", {{"index", 0}}}});
  expect_near(glm::vec3(load(b).meshes.at(0).tangents.at(0)), {0, 1, 0});
}

TEST(GltfPose, ShutterTellsOfWhatItDoesNotMove) {
  GltfBuilder b = GltfBuilder::triangle();
  b.primitive()["attributes"]["COLOR_0"] = b.floats("VEC3", std::vector<float>(9, 0.0f));
  b.primitive()["targets"] = {{{"COLOR_0", b.floats("VEC3", std::vector<float>(9, 1.0f))}}};
  const int times = b.floats("SCALAR", {0, 1}), weights = b.floats("SCALAR", {0, 1});
  b.add("animations", {{"samplers", {{{"input", times}, {"output", weights}}}},
                       {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}});
  LoadOptions options{"", "0", 0.0};
  options.shutter = {0.25, 0.75};
  const Scene scene = load(b, options);
  EXPECT_EQ(scene.meshes.at(0).colors[0], glm::vec4(0.25, 0.25, 0.25, 1));
  EXPECT_EQ(test::warning_count(scene, "stay as it opens"), 1u);
}

// Extensions may move what has no node, and other paths may come.
TEST(GltfPose, ChannelsThatMoveNothingKnownAreTold) {
  GltfBuilder b = GltfBuilder::triangle();
  const int times = b.floats("SCALAR", {0, 1}), values = b.floats("VEC3", {0, 0, 0, 1, 0, 0});
  b.add("animations",
        {{"samplers", {{{"input", times}, {"output", values}}}},
         {"channels",
          {{{"sampler", 0}, {"target", {{"path", "pointer"}, {"extensions", {{"ACME_moves", {{"what", 0}}}}}}}},
           {{"sampler", 0}, {"target", {{"path", "shape"}, {"node", 0}}}}}}});
  EXPECT_EQ(test::warning_count(load(b, {"", "0", 1.0}), "channel that moves nothing known"), 2u);
  EXPECT_TRUE(load(b).warnings.empty());
  b.root["extensionsUsed"] = {"ACME_moves"};
  EXPECT_EQ(test::warning_count(load(b), "not supported, ignored: ACME_moves"), 1u);
}

GltfBuilder skinned() {
  GltfBuilder b = GltfBuilder::triangle();
  auto& attributes = b.primitive()["attributes"];
  attributes["NORMAL"] = b.floats("VEC3", {1, 0, 0, 1, 0, 0, 1, 0, 0});
  attributes["JOINTS_0"] = b.accessor<std::uint8_t>("VEC4", test::kUbyte, {0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0});
  attributes["WEIGHTS_0"] =
      b.accessor<std::uint8_t>("VEC4", test::kUbyte, {255, 0, 0, 0, 255, 0, 0, 0, 51, 204, 0, 0}, true);
  const int inverse_bind = b.floats(
      "MAT4", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1});
  b.root["nodes"][0]["translation"] = {100, 100, 100}; // ignored: joints place the mesh
  b.root["nodes"][0]["skin"] = 0;
  const double h = std::sqrt(0.5);
  b.add("nodes", {{"translation", {0, 0, 5}}, {"children", {2}}});
  b.add("nodes", {{"translation", {1, 0, 0}}, {"rotation", {0, 0, h, h}}, {"scale", {1, 2, 1}}});
  b.add("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", inverse_bind}});
  return b;
}

TEST(GltfPose, SkinsPoseTheMeshInWorldSpace) {
  const Scene scene = load(skinned());
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].world_from_object, glm::dmat4(1.0));
  const Mesh& mesh = scene.meshes[0];
  expect_near(mesh.positions[0], {0, 0, 5}); // joint 0
  expect_near(mesh.positions[1], {1, 0, 5}); // at joint 1's origin
  // (0,1,0): joint 0 gives (0,1,5); joint 1: (-1,1,0) scaled to (-1,2,0), turned to (-2,-1,0), moved to (-1,-1,5).
  expect_near(mesh.positions[2], glm::dvec3(0, 1, 5) * 0.2 + glm::dvec3(-1, -1, 5) * 0.8, 1e-5);
  expect_near(mesh.normals[1], {0, 1, 0}); // +x turned by 90 degrees
}

// The triangle with keys at 1 s and 3 s; the values are the accessor that the caller adds next.
GltfBuilder animated(const std::string& path, const std::string& interpolation) {
  GltfBuilder b = GltfBuilder::triangle();
  b.add("animations", {{"name", "move"},
                       {"samplers", {{{"input", 1}, {"output", 2}, {"interpolation", interpolation}}}},
                       {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}}});
  b.floats("SCALAR", {1, 3});
  return b;
}

glm::dvec3 moved(const GltfBuilder& builder, double seconds, const glm::dvec4& point = {0, 0, 0, 1}) {
  return load(builder, {"", "move", seconds}).instances.at(0).world_from_object * point;
}

// Motion while the shutter is open: the same vertices at both moments, in the space of the mesh.
TEST(GltfPose, ShutterMovesNodes) {
  GltfBuilder b = animated("translation", "LINEAR");
  b.floats("VEC3", {2, 0, 0, 6, 0, 8});
  b.root["nodes"][0]["scale"] = {2, 2, 2};
  b.add("nodes", {{"mesh", 0}}); // the same mesh, which stands still
  LoadOptions options{"", "move", 0.0};
  options.shutter = {1.5, 2.0};
  const Scene scene = load(b, options);
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_NE(scene.instances[0].mesh, scene.instances[1].mesh) << "what stands still shares no mesh with what moves";
  EXPECT_FALSE(scene.meshes[scene.instances[1].mesh].moves());
  const Mesh& mesh = scene.meshes[scene.instances[0].mesh];
  ASSERT_TRUE(mesh.moves());
  expect_near(glm::dvec3(scene.instances[0].world_from_object * glm::dvec4(mesh.positions[0], 1.0)), {3, 0, 2}, 1e-6);
  expect_near(glm::dvec3(scene.instances[0].world_from_object * glm::dvec4(mesh.end_positions[0], 1.0)), {4, 0, 4},
              1e-6);
  options.shutter = {5.0, 6.0}; // after the last key
  EXPECT_FALSE(load(b, options).meshes[0].moves());
}

TEST(GltfPose, ShutterTurnsNormals) {
  GltfBuilder b = animated("rotation", "LINEAR");
  const float h = std::sqrt(0.5f);
  b.floats("VEC4", {0, 0, 0, 1, 0, h, 0, h}); // a quarter turn about +Y
  b.primitive()["attributes"]["NORMAL"] = b.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
  LoadOptions options{"", "move", 0.0};
  options.shutter = {1.0, 3.0};
  const Mesh mesh = load(b, options).meshes[0];
  ASSERT_EQ(mesh.end_normals.size(), 3u);
  expect_near(mesh.end_normals[0], {1, 0, 0}, 1e-6);
  expect_near(mesh.end_positions[1], {0, 0, -1}, 1e-6);
}

TEST(GltfPose, ShutterMovesSkinsAndMorphTargets) {
  GltfBuilder skin = skinned();
  skin.add(
      "animations",
      {{"name", "move"},
       {"samplers", {{{"input", skin.floats("SCALAR", {0, 1})}, {"output", skin.floats("VEC3", {0, 0, 5, 0, 3, 5})}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}}});
  LoadOptions options{"", "move", 0.0};
  options.shutter = {0.0, 1.0};
  const Mesh mesh = load(skin, options).meshes[0];
  ASSERT_TRUE(mesh.moves());
  for (int i = 0; i < 3; ++i) expect_near(mesh.end_positions[i] - mesh.positions[i], {0, 3, 0}, 1e-5);

  GltfBuilder morph = animated("weights", "LINEAR");
  morph.floats("SCALAR", {0, 1});
  morph.primitive()["targets"] = {{{"POSITION", morph.floats("VEC3", {0, 0, 2, 0, 0, 0, 0, 0, 0})}}};
  options.shutter = {1.0, 2.0};
  const Mesh shaped = load(morph, options).meshes[0];
  ASSERT_TRUE(shaped.moves());
  expect_near(shaped.end_positions[0], {0, 0, 1}, 1e-6);
  expect_near(shaped.end_positions[1], {1, 0, 0}, 1e-6);
}

TEST(GltfPose, LinearAndStepAnimation) {
  GltfBuilder linear = animated("translation", "LINEAR");
  linear.floats("VEC3", {2, 0, 0, 6, 0, 8});
  expect_near(moved(linear, 0), {2, 0, 0}); // held
  expect_near(moved(linear, 1.5), {3, 0, 2});
  expect_near(moved(linear, 9), {6, 0, 8});
  EXPECT_EQ(load(linear).instances[0].world_from_object, glm::dmat4(1.0)); // at rest unless asked
  GltfBuilder step = animated("scale", "STEP");
  step.floats("VEC3", {2, 2, 2, 6, 6, 6});
  expect_near(moved(step, 2.9, {1, 0, 0, 1}), {2, 0, 0});
  expect_near(moved(step, 3.0, {1, 0, 0, 1}), {6, 0, 0});
}

TEST(GltfPose, RotationsTakeTheShorterArc) {
  GltfBuilder b = animated("rotation", "LINEAR");
  const auto h = static_cast<float>(std::sqrt(0.5));
  b.floats("VEC4", {0, 0, 0, 1, 0, 0, -h, -h}); // 90 degrees about z, with the other sign
  const double angle = 0.25 * std::acos(0.0);
  expect_near(moved(b, 1.5, {1, 0, 0, 1}), {std::cos(angle), std::sin(angle), 0});
}

TEST(GltfPose, CubicSplineAnimation) {
  GltfBuilder b = animated("translation", "CUBICSPLINE");
  // In-tangent, value, out-tangent at each of the two keys, 2 s apart.
  b.floats("VEC3", {9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 2, 0, 4, 0, 0, 9, 9, 9});
  // Halfway the Hermite basis is 1/2, 1/8, 1/2, -1/8; tangents count times the duration.
  expect_near(moved(b, 2.0), {0.5 * 0 + 0.125 * 2 * 1 + 0.5 * 4, -0.125 * 2 * 2, 0});
  expect_near(moved(b, 3.0), {4, 0, 0});
}

TEST(GltfPose, AnimatedMorphWeights) {
  GltfBuilder b = animated("weights", "LINEAR");
  b.floats("SCALAR", {0, 1, 1, 0}); // two targets at two times
  b.primitive()["targets"] = {{{"POSITION", b.floats("VEC3", {0, 0, 4, 0, 0, 0, 0, 0, 0})}},
                              {{"POSITION", b.floats("VEC3", {0, 8, 0, 0, 0, 0, 0, 0, 0})}}};
  const Scene scene = load(b, {"", "0", 1.5});
  EXPECT_EQ(scene.meshes[0].positions[0], glm::vec3(0, 6, 1));
}

} // namespace
} // namespace wavepath
