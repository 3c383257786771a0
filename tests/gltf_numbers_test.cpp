// Numbers that are not finite, in every place of a glTF file that may hold one: told once a kind, with a count, and
// mended, so that the rest of the file is seen as if they were not there.
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "tests/gltf_checks.h"

namespace wavepath {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using test::load;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

// The triangle with everything that a primitive can have: normals, tangents (its material has a normal map), two sets
// of texture coordinates, colours, a skin of one joint and a morph target.
GltfBuilder everything() {
  GltfBuilder b = GltfBuilder::triangle();
  json& primitive = b.primitive();
  primitive["attributes"]["NORMAL"] = b.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
  primitive["attributes"]["TANGENT"] = b.floats("VEC4", {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1});
  primitive["attributes"]["TEXCOORD_0"] = b.floats("VEC2", {0, 0, 1, 0, 0, 1});
  primitive["attributes"]["TEXCOORD_1"] = b.floats("VEC2", {0, 0, 1, 0, 0, 1});
  primitive["attributes"]["COLOR_0"] = b.floats("VEC4", std::vector<float>(12, 0.5f));
  primitive["attributes"]["JOINTS_0"] = b.accessor<std::uint8_t>("VEC4", test::kUbyte, std::vector<std::uint8_t>(12));
  primitive["attributes"]["WEIGHTS_0"] = b.floats("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  primitive["targets"] = {{{"POSITION", b.floats("VEC3", std::vector<float>(9))},
                           {"NORMAL", b.floats("VEC3", std::vector<float>(9))},
                           {"TANGENT", b.floats("VEC3", std::vector<float>(9))},
                           {"TEXCOORD_0", b.floats("VEC2", std::vector<float>(6))},
                           {"COLOR_0", b.floats("VEC4", std::vector<float>(12))}}};
  b.root["meshes"][0]["weights"] = {1};
  b.add("images", {{"bufferView", b.view(std::string(test::kPng, sizeof(test::kPng) - 1))}});
  b.add("textures", {{"source", 0}});
  primitive["material"] =
      b.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"texCoord", 1}}}}},
                          {"normalTexture", {{"index", 0}}}});
  b.add("nodes", json::object());
  const int matrix = b.floats("MAT4", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
  b.root["nodes"][0]["skin"] = b.add("skins", {{"joints", {1}}, {"inverseBindMatrices", matrix}});
  return b;
}

// Overwrites a float in the data of an accessor.
void spoil(GltfBuilder& b, const json& accessor, std::size_t at, float value) {
  const json& view = b.root["bufferViews"][b.root["accessors"][accessor.get<unsigned>()]["bufferView"].get<unsigned>()];
  std::memcpy(&b.bytes[view["byteOffset"].get<std::size_t>() + at * sizeof(float)], &value, sizeof(float));
}

template <class Vectors>
bool all_finite(const Vectors& vectors) {
  for (const auto& vector : vectors)
    for (int c = 0; c < vector.length(); ++c)
      if (!std::isfinite(vector[c])) return false;
  return true;
}

bool all_finite(const Mesh& mesh) {
  return all_finite(mesh.positions) && all_finite(mesh.normals) && all_finite(mesh.tangents) &&
         all_finite(mesh.uvs[0]) && all_finite(mesh.uvs[1]) && all_finite(mesh.colors);
}

struct Poisoned {
  const char *attribute, *target; // one of them
  std::size_t at;
  float value;
  const char* told;
};

TEST(GltfNumbers, OfEveryAttributeAreMended) {
  const Scene whole = load(everything());
  EXPECT_TRUE(whole.warnings.empty()) << whole.warnings.counts().begin()->first;
  const char *uvs = "texture coordinates that are not finite", *colors = "colours that are not finite",
             *normals = "normal without a direction", *tangents = "tangent without a direction",
             *weights = "weights of joints that are not finite", *targets = "morph targets that are not finite";
  const Poisoned cases[] = {
      {"TEXCOORD_0", nullptr, 2, kNan, uvs},     {"TEXCOORD_0", nullptr, 5, kInf, uvs},
      {"TEXCOORD_1", nullptr, 0, -kInf, uvs},    {"COLOR_0", nullptr, 1, kNan, colors},
      {"COLOR_0", nullptr, 7, kInf, colors},     {"COLOR_0", nullptr, 8, -kInf, colors},
      {"NORMAL", nullptr, 0, kNan, normals},     {"NORMAL", nullptr, 5, kInf, normals},
      {"TANGENT", nullptr, 0, kNan, tangents},   {"TANGENT", nullptr, 7, kNan, tangents},
      {"TANGENT", nullptr, 4, -kInf, tangents},  {"WEIGHTS_0", nullptr, 0, kNan, weights},
      {"WEIGHTS_0", nullptr, 6, kInf, weights},  {"WEIGHTS_0", nullptr, 11, -kInf, weights},
      {nullptr, "POSITION", 3, kNan, targets},   {nullptr, "POSITION", 8, kInf, targets},
      {nullptr, "NORMAL", 0, kNan, targets},     {nullptr, "TANGENT", 4, kInf, targets},
      {nullptr, "TEXCOORD_0", 1, kNan, targets}, {nullptr, "COLOR_0", 4, kNan, targets},
  };
  for (const Poisoned& poisoned : cases) {
    GltfBuilder b = everything();
    const json accessor = poisoned.attribute ? b.primitive()["attributes"][poisoned.attribute]
                                             : b.primitive()["targets"][0][poisoned.target];
    spoil(b, accessor, poisoned.at, poisoned.value);
    const Scene scene = load(b);
    SCOPED_TRACE(testing::Message() << (poisoned.attribute ? poisoned.attribute : poisoned.target) << " "
                                    << poisoned.at);
    EXPECT_TRUE(all_finite(scene.meshes.at(0)));
    EXPECT_EQ(scene.warnings.counts().size(), 1u);
    EXPECT_EQ(test::warning_count(scene, poisoned.told), 1u);
    EXPECT_EQ(scene.meshes[0].positions, whole.meshes[0].positions);
  }
}

TEST(GltfNumbers, AreMendedToWhatChangesLeast) {
  GltfBuilder b = everything();
  const json& attributes = b.primitive()["attributes"];
  spoil(b, attributes["COLOR_0"], 1, kNan);
  spoil(b, attributes["COLOR_0"], 3, kNan);
  spoil(b, attributes["COLOR_0"], 8, -kInf);
  spoil(b, attributes["TEXCOORD_1"], 3, kNan);
  spoil(b, attributes["NORMAL"], 3, kNan);
  const Scene scene = load(b);
  EXPECT_EQ(scene.meshes[0].colors, (std::vector<glm::vec4>{{0.5, 1, 0.5, 1}, glm::vec4(0.5), {1, 0.5, 0.5, 0.5}}));
  EXPECT_EQ(scene.meshes[0].uvs[1], (std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}}));
  EXPECT_EQ(scene.meshes[0].normals[1], glm::vec3(0, 0, 1));
  EXPECT_EQ(test::warning_count(scene, "colours"), 2u) << "vertices, not numbers";
}

TEST(GltfNumbers, OfSparseAccessors) {
  GltfBuilder b = everything();
  const int indices = b.view(std::vector<std::uint8_t>{1}), values = b.view(std::vector<float>{kNan, 0, 0, 1});
  b.root["accessors"][b.primitive()["attributes"]["COLOR_0"].get<unsigned>()]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
      {"values", {{"bufferView", values}}}};
  const Scene scene = load(b);
  EXPECT_EQ(scene.meshes[0].colors[1], glm::vec4(1, 0, 0, 1));
  EXPECT_EQ(test::warning_count(scene, "colours that are not finite"), 1u);
}

TEST(GltfNumbers, OfBindMatrices) {
  GltfBuilder b = everything();
  spoil(b, b.root["skins"][0]["inverseBindMatrices"], 13, kNan);
  const Scene scene = load(b);
  EXPECT_TRUE(all_finite(scene.meshes[0]));
  EXPECT_EQ(test::warning_count(scene, "inverse bind matrix that is not finite"), 1u);
}

TEST(GltfNumbers, OfInstancesLeaveThoseOut) {
  for (const char* name : {"TRANSLATION", "ROTATION", "SCALE"}) {
    GltfBuilder b = GltfBuilder::triangle();
    json& attributes = b.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    attributes = {{"TRANSLATION", b.floats("VEC3", {0, 0, 0, 0, 5, 0})},
                  {"ROTATION", b.floats("VEC4", {0, 0, 0, 1, 0, 0, 0, 1})},
                  {"SCALE", b.floats("VEC3", {1, 1, 1, 2, 2, 2})}};
    spoil(b, attributes[name], 0, kNan);
    const Scene scene = load(b);
    EXPECT_EQ(scene.instances.size(), 1u) << name;
    EXPECT_EQ(test::warning_count(scene, "instance"), 1u) << name;
  }
}

TEST(GltfNumbers, OfAnimationsAreRefused) {
  for (const unsigned accessor : {6u, 7u}) { // times, translations
    GltfBuilder b = test::full();
    spoil(b, accessor, 1, kNan);
    EXPECT_NO_THROW(load(b));
    EXPECT_THROW(load(b, {"", "move", 0.0}), Error) << accessor;
  }
}

// The packer drops the triangles, and says so.
TEST(GltfNumbers, OfPositionsStay) {
  GltfBuilder b = everything();
  spoil(b, 0, 4, kNan);
  EXPECT_TRUE(std::isnan(load(b).meshes[0].positions[1].y));
}

// JSON has no word for infinity, but numbers that floats do not have.
TEST(GltfNumbers, OfJsonThatFloatsDoNotHold) {
  GltfBuilder b = test::full();
  b.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
      {"offset", {1e300, 0}}};
  Scene scene = load(b);
  EXPECT_FALSE(scene.materials.at(0).base_color_texture.transformed());
  EXPECT_EQ(test::warning_count(scene, "texture transform of numbers too large"), 1u);
  b = test::full();
  b.root["meshes"][0]["weights"] = {1e300};
  scene = load(b);
  EXPECT_TRUE(all_finite(scene.meshes.at(0)));
  EXPECT_EQ(test::warning_count(scene, "morph targets that are not finite"), 3u); // as a float it is infinite
  b = test::full();
  b.root["nodes"][2]["translation"] = {0, 1e300, 0};
  scene = load(b);
  EXPECT_TRUE(scene.cameras.empty());
  EXPECT_EQ(test::warning_count(scene, "camera beyond the largest coordinates"), 1u);
  b = test::full();
  b.root["cameras"][0]["perspective"]["aspectRatio"] = 1e300;
  EXPECT_THROW(load(b), Error);
  b.root["cameras"][0] = {{"type", "orthographic"},
                          {"orthographic", {{"xmag", 1}, {"ymag", 1e300}, {"znear", 0}, {"zfar", 1}}}};
  EXPECT_THROW(load(b), Error);
}

} // namespace
} // namespace wavepath
