// glTF import: KHR_animation_pointer, KHR_materials_variants, and visibility that an animation changes.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "tests/gltf_checks.h"

namespace wavepath {
namespace {

using nlohmann::json;
using test::expect_near;
using test::GltfBuilder;
using test::load;
using test::warning_count;

constexpr const char* kPointer = "KHR_animation_pointer";

// A triangle with a material of many extensions and a texture, a hidden node, lights, two cameras.
GltfBuilder stage() {
  GltfBuilder b = GltfBuilder::triangle();
  b.primitive()["attributes"]["TEXCOORD_0"] = b.floats("VEC2", {0, 0, 1, 0, 0, 1});
  b.primitive()["targets"] = {{{"POSITION", b.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1})}},
                              {{"POSITION", b.floats("VEC3", {0, 1, 0, 0, 1, 0, 0, 1, 0})}}};
  b.root["meshes"][0]["weights"] = {0.5, 0.25};
  b.add("images", {{"bufferView", b.view(std::string(test::kPng, sizeof(test::kPng) - 1))}});
  b.add("textures", {{"source", 0}});
  b.primitive()["material"] =
      b.add("materials",
            {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
             {"extensions",
              {{"KHR_materials_volume", {{"thicknessFactor", 1}, {"attenuationDistance", 2}}},
               {"KHR_materials_transmission", {{"transmissionFactor", 0}, {"transmissionTexture", {{"index", 0}}}}},
               {"KHR_materials_emissive_strength", {{"emissiveStrength", 2}}}}}});
  b.root["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}}, {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}}};
  for (int light = 0; light < 2; ++light)
    b.add("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
  b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}});
  b.add("cameras",
        {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0.1}, {"zfar", 9}}}});
  for (int camera = 0; camera < 2; ++camera) b.add("nodes", {{"camera", camera}});
  b.add("nodes", {{"mesh", 0}, {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}}); // node 5
  b.add("animations", {{"samplers", json::array()}, {"channels", json::array()}});
  b.root["extensionsUsed"] = {kPointer};
  return b;
}

// Moves what the pointer names over the seconds 0 to 1, or 0, 1, 2, ...
void animate(GltfBuilder& b, const std::string& pointer, const std::string& type, const std::vector<float>& values,
             const std::string& interpolation = "LINEAR", int accessor = -1) {
  const std::size_t width = type == "SCALAR" ? 1 : static_cast<std::size_t>(type[3] - '0');
  const std::size_t keys = values.size() / width / (interpolation == "CUBICSPLINE" ? 3 : 1);
  std::vector<float> times;
  for (std::size_t i = 0; i < keys; ++i) times.push_back(static_cast<float>(i));
  json& animation = b.root["animations"][0];
  const int output = accessor >= 0 ? accessor : b.floats(type, values);
  animation["samplers"].push_back(
      {{"input", b.floats("SCALAR", times)}, {"output", output}, {"interpolation", interpolation}});
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size() - 1},
       {"target", {{"path", "pointer"}, {"extensions", {{kPointer, {{"pointer", pointer}}}}}}}});
}

Scene at(const GltfBuilder& b, double seconds) { return load(b, {.animation = "0", .at = seconds}); }

TEST(GltfPointer, Nodes) {
  GltfBuilder b = stage();
  animate(b, "/nodes/0/translation", "VEC3", {0, 0, 0, 2, 4, 6});
  animate(b, "/nodes/0/scale", "VEC3", {1, 1, 1, 3, 3, 3});
  const float h = std::sqrt(0.5f);
  animate(b, "/nodes/0/weights/1", "SCALAR", {0, 1});
  const Scene scene = at(b, 0.5);
  expect_near(scene.instances.at(0).world_from_object[3], {1, 2, 3});
  expect_near(scene.instances.at(0).world_from_object[0], {2, 0, 0});
  EXPECT_EQ(scene.meshes.at(0).positions[0], glm::vec3(0, 0.5, 0.5)) << "the other weight is that of the mesh";
  EXPECT_TRUE(scene.warnings.empty());
  GltfBuilder turned = stage();
  animate(turned, "/nodes/2/rotation", "VEC4", {0, 0, 0, 1, h, 0, 0, h});
  const double angle = std::numbers::pi / 4; // a slerp; a straight line would not stay on the arc at one third
  expect_near(at(turned, 0.5).lights.at(1).direction, {0, std::sin(angle), -std::cos(angle)});
  expect_near(at(turned, 1.0 / 3).lights.at(1).direction, {0, std::sin(angle * 2 / 3), -std::cos(angle * 2 / 3)});
}

TEST(GltfPointer, WholeWeights) {
  GltfBuilder b = stage();
  animate(b, "/nodes/0/weights", "SCALAR", {1, 0, 0, 1}); // two keys of two weights
  json& sampler = b.root["animations"][0]["samplers"][0];
  sampler["input"] = b.floats("SCALAR", {0, 1});
  EXPECT_EQ(at(b, 0.0).meshes.at(0).positions[0], glm::vec3(0, 0, 1));
  EXPECT_EQ(at(b, 1.0).meshes.at(0).positions[0], glm::vec3(0, 1, 0));
}

TEST(GltfPointer, VisibilityStepsAndHidesWhatIsBelow) {
  GltfBuilder b = stage();
  const int values = b.accessor<std::uint8_t>("SCALAR", test::kUbyte, {0, 1});
  animate(b, "/nodes/5/extensions/KHR_node_visibility/visible", "SCALAR", {0, 1}, "STEP", values);
  animate(b, "/nodes/1/extensions/KHR_node_visibility/visible", "SCALAR", {1, 0}, "STEP"); // a lamp
  EXPECT_EQ(at(b, 0.9).instances.size(), 1u);
  EXPECT_EQ(at(b, 0.9).lights.size(), 2u);
  EXPECT_EQ(at(b, 1.0).instances.size(), 2u);
  EXPECT_EQ(at(b, 1.0).lights.size(), 1u);
  animate(b, "/nodes/0/extensions/KHR_node_visibility/visible", "SCALAR", {0, 1}); // neither true nor false between
  EXPECT_THROW(at(b, 0.0), Error);
}

TEST(GltfPointer, Materials) {
  GltfBuilder b = stage();
  const std::string material = "/materials/0/", extensions = material + "extensions/";
  animate(b, material + "pbrMetallicRoughness/baseColorFactor", "VEC4", {0, 0, 0, 0, 1, 0.5, 0.25, 1});
  animate(b, material + "pbrMetallicRoughness/roughnessFactor", "SCALAR", {0, 1});
  animate(b, material + "pbrMetallicRoughness/metallicFactor", "SCALAR", {0, 0, 1, 0, 1, 0}, "CUBICSPLINE");
  animate(b, material + "emissiveFactor", "VEC3", {0, 0, 0, 1, 1, 1});
  animate(b, extensions + "KHR_materials_emissive_strength/emissiveStrength", "SCALAR", {0, 8});
  animate(b, extensions + "KHR_materials_volume/attenuationDistance", "SCALAR", {1, 3});
  animate(b, extensions + "KHR_materials_volume/attenuationColor", "VEC3", {1, 1, 1, 0, 0, 0});
  animate(b, extensions + "KHR_materials_transmission/transmissionFactor", "SCALAR", {0, 1});
  const std::string transform = material + "pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/";
  animate(b, transform + "offset", "VEC2", {0, 0, 1, 2});
  animate(b, transform + "rotation", "SCALAR", {0, 1});
  animate(b, transform + "scale", "VEC2", {1, 1, 3, 5});
  const Scene scene = at(b, 0.5);
  EXPECT_TRUE(scene.warnings.empty());
  const Material& m = scene.materials.at(0);
  EXPECT_EQ(m.base_color, glm::vec4(0.5, 0.25, 0.125, 0.5));
  EXPECT_EQ(m.roughness, 0.5f);
  EXPECT_FLOAT_EQ(m.metallic, 0.5f + 0.125f) << "a cubic spline from 0, with slope 1, to 1 with slope 0";
  EXPECT_EQ(m.emission, glm::vec3(2));
  EXPECT_FLOAT_EQ(m.attenuation.x, static_cast<float>(-std::log(0.5) / 2));
  EXPECT_EQ(m.transmission, 0.5f);
  EXPECT_EQ(m.base_color_texture.uv_offset, glm::vec2(0.5, 1));
  EXPECT_NEAR(glm::length(m.base_color_texture.uv_matrix[0]), 2.0, 1e-6);
  EXPECT_NEAR(glm::length(m.base_color_texture.uv_matrix[1]), 3.0, 1e-6);
  EXPECT_NEAR(m.base_color_texture.uv_matrix[0].y, -2 * std::sin(0.5), 1e-6);
  EXPECT_EQ(load(b).materials.at(0).roughness, 1.0f) << "without the animation";
}

TEST(GltfPointer, LightsAndCameras) {
  GltfBuilder b = stage();
  const std::string lights = "/extensions/KHR_lights_punctual/lights/";
  animate(b, lights + "0/color", "VEC3", {0, 0, 0, 1, 0.5, 0});
  animate(b, lights + "0/intensity", "SCALAR", {0, 8});
  animate(b, lights + "0/range", "SCALAR", {1, 3});
  animate(b, lights + "1/spot/innerConeAngle", "SCALAR", {0.1f, 0.3f});
  animate(b, lights + "1/spot/outerConeAngle", "SCALAR", {0.2f, 0.8f});
  animate(b, "/cameras/0/perspective/yfov", "SCALAR", {1, 2});
  animate(b, "/cameras/0/perspective/znear", "SCALAR", {1, 2});
  animate(b, "/cameras/0/perspective/zfar", "SCALAR", {10, 20});
  animate(b, "/cameras/1/orthographic/xmag", "SCALAR", {1, 3});
  animate(b, "/cameras/1/orthographic/ymag", "SCALAR", {2, 4});
  const Scene scene = at(b, 0.5);
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_EQ(scene.lights.at(0).intensity, glm::vec3(2, 1, 0));
  EXPECT_EQ(scene.lights.at(0).range, 2.0);
  EXPECT_NEAR(scene.lights.at(1).inner_cone, 0.2, 1e-6);
  EXPECT_NEAR(scene.lights.at(1).outer_cone, 0.5, 1e-6);
  EXPECT_EQ(scene.cameras.at(0).yfov, 1.5);
  EXPECT_EQ(scene.cameras.at(0).znear, 1.5);
  EXPECT_EQ(scene.cameras.at(0).zfar, 15.0);
  EXPECT_EQ(scene.cameras.at(1).xmag, 2.0);
  EXPECT_EQ(scene.cameras.at(1).ymag, 3.0);
}

TEST(GltfPointer, WhatIsNotKnownIsNamedWithItsCount) {
  GltfBuilder b = stage();
  animate(b, "/materials/0/extensions/KHR_materials_sheen/sheenRoughnessFactor", "SCALAR", {0, 1}); // it has no sheen
  animate(b, "/materials/7/alphaCutoff", "SCALAR", {0, 1});
  animate(b, "/nodes/0/extensions/ACME_thing/size", "SCALAR", {0, 1});
  animate(b, "/nodes/1/extensions/ACME_thing/size", "SCALAR", {0, 1});
  animate(b, "nonsense", "SCALAR", {0, 1});
  animate(b, "/materials/0/occlusionTexture/strength", "SCALAR", {0, 1}); // known, and changes no picture
  const Scene scene = at(b, 0.5);
  EXPECT_EQ(warning_count(scene, "animation of /nodes/{}/extensions/ACME_thing/size ignored"), 2u);
  EXPECT_EQ(warning_count(scene, "sheenRoughnessFactor ignored"), 1u);
  EXPECT_EQ(warning_count(scene, "/materials/{}/alphaCutoff ignored"), 1u);
  EXPECT_EQ(warning_count(scene, "nonsense"), 1u);
  EXPECT_EQ(warning_count(scene, "occlusion"), 0u);
  EXPECT_TRUE(load(b).warnings.empty()) << "nothing is ignored without the animation";
}

TEST(GltfPointer, ShutterBlursNodesAndTellsOfTheRest) {
  GltfBuilder b = stage();
  animate(b, "/nodes/0/translation", "VEC3", {0, 0, 0, 2, 0, 0});
  animate(b, "/materials/0/pbrMetallicRoughness/roughnessFactor", "SCALAR", {0, 1});
  animate(b, "/nodes/5/extensions/KHR_node_visibility/visible", "SCALAR", {0, 1}, "STEP");
  animate(b, "/extensions/KHR_lights_punctual/lights/0/intensity", "SCALAR", {0, 8});
  animate(b, "/cameras/0/perspective/yfov", "SCALAR", {1, 2});
  LoadOptions options{.animation = "0"};
  options.shutter = {0.5, 1.0};
  const Scene scene = load(b, options);
  EXPECT_EQ(scene.instances.size(), 1u);
  EXPECT_TRUE(scene.meshes.at(scene.instances[0].mesh).moves());
  EXPECT_EQ(scene.materials.at(0).roughness, 0.5f);
  EXPECT_EQ(scene.lights.at(0).intensity.x, 4.0f);
  EXPECT_EQ(scene.cameras.at(0).yfov, 1.5);
  for (const char* part : {"materials", "visibility of nodes", "lights", "cameras"})
    EXPECT_EQ(warning_count(scene, std::string("animated ") + part + " that change while the shutter is open"), 1u);
}

// Moments of one file, one after the other, are those of files that are opened for them.
TEST(GltfPointer, PosesOfOneFile) {
  GltfBuilder b = stage();
  animate(b, "/materials/0/pbrMetallicRoughness/roughnessFactor", "SCALAR", {0, 1});
  animate(b, "/materials/0/extensions/KHR_materials_transmission/transmissionFactor", "SCALAR", {0, 1});
  animate(b, "/nodes/5/extensions/KHR_node_visibility/visible", "SCALAR", {0, 1, 0}, "STEP");
  test::TempFolder folder;
  const auto path = folder.write("scene.gltf", b.json());
  GltfFile file(path);
  Scene scene = file.load({.animation = "0"});
  for (const double moment : {0.25, 1.0, 0.5, 2.0}) {
    scene = file.pose({.animation = "0", .at = moment}, std::move(scene));
    const Scene alone = load_gltf(path, {.animation = "0", .at = moment});
    EXPECT_EQ(scene.materials.at(0).roughness, alone.materials.at(0).roughness) << moment;
    EXPECT_EQ(scene.materials.at(0).transmission, alone.materials.at(0).transmission) << moment;
    EXPECT_EQ(scene.instances.size(), alone.instances.size()) << moment;
    EXPECT_FALSE(file.keeps_materials());
    ASSERT_EQ(scene.images.size(), 1u);
    EXPECT_EQ(scene.images[0].bytes, alone.images.at(0).bytes);
    EXPECT_FALSE(scene.meshes.at(0).positions.empty());
  }
  file.set_visible(5, true); // what the user says holds
  scene = file.pose({.animation = "0", .at = 0.0}, std::move(scene));
  EXPECT_EQ(scene.instances.size(), 2u);
}

// ---- KHR_materials_variants

GltfBuilder shoe() {
  GltfBuilder b = GltfBuilder::triangle();
  b.primitive()["attributes"]["TEXCOORD_0"] = b.floats("VEC2", {0, 0, 1, 0, 0, 1});
  b.add("images", {{"bufferView", b.view(std::string(test::kPng, sizeof(test::kPng) - 1))}});
  b.add("textures", {{"source", 0}});
  for (const char* name : {"grey", "red", "brown"}) b.add("materials", {{"name", name}});
  b.root["materials"][1]["pbrMetallicRoughness"] = {{"baseColorTexture", {{"index", 0}}}};
  b.primitive()["material"] = 0;
  b.root["extensionsUsed"] = {"KHR_materials_variants"};
  b.root["extensions"]["KHR_materials_variants"]["variants"] = {
      {{"name", "Red"}}, {{"name", "Brown"}}, {{"name", "Plain"}}};
  b.primitive()["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {0}}},
                                                                       {{"material", 2}, {"variants", {1}}}};
  return b;
}

std::string shown_material(const Scene& scene) {
  return scene.materials.at(scene.meshes.at(scene.instances.at(0).mesh).primitives.at(0).material).name;
}

TEST(GltfVariants, ChosenByName) {
  const GltfBuilder b = shoe();
  EXPECT_EQ(load(b).variants, (std::vector<std::string>{"Red", "Brown", "Plain"}));
  EXPECT_EQ(shown_material(load(b)), "grey");
  EXPECT_EQ(shown_material(load(b, {.variant = "Red"})), "red");
  EXPECT_EQ(shown_material(load(b, {.variant = "Brown"})), "brown");
  EXPECT_EQ(shown_material(load(b, {.variant = "Plain"})), "grey") << "no mapping has it";
  EXPECT_EQ(load(b, {.variant = "Red"}).materials.size(), 1u) << "others are not read";
  EXPECT_EQ(load(b, {.variant = "Red"}).images.size(), 1u);
  EXPECT_EQ(load(b).images.size(), 0u);
}

TEST(GltfVariants, UnknownNamesAreRefusedWithThoseThatThereAre) {
  const auto message = [](const GltfBuilder& b, const char* variant) -> std::string {
    try {
      load(b, {.variant = variant});
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message(shoe(), "red").find("has no variant 'red'; choose one of 'Red', 'Brown', 'Plain'"),
            std::string::npos)
      << message(shoe(), "red");
  EXPECT_NE(message(GltfBuilder::triangle(), "red").find("it has no variants"), std::string::npos);
  GltfBuilder b = shoe();
  b.primitive()["extensions"]["KHR_materials_variants"]["mappings"][0]["variants"] = {3};
  EXPECT_THROW(load(b), Error);
  b.primitive()["extensions"]["KHR_materials_variants"]["mappings"][0] = {{"material", 9}, {"variants", {0}}};
  EXPECT_THROW(load(b), Error);
}

// Another variant of a file that stays open has its images decoded then.
TEST(GltfVariants, ChangedInAnOpenFile) {
  test::TempFolder folder;
  GltfFile file(folder.write("scene.gltf", shoe().json()));
  Scene scene = file.load();
  for (const char* variant : {"Red", "", "Brown", "Red", "Plain"}) {
    scene = file.pose({.variant = variant}, std::move(scene));
    const std::string name = variant;
    EXPECT_EQ(shown_material(scene), name == "Red" ? "red" : name == "Brown" ? "brown" : "grey");
    EXPECT_EQ(scene.images.size(), 1u);
    EXPECT_EQ(scene.images.at(0).bytes.size(), 4u);
    EXPECT_FALSE(file.keeps_materials() && name != "Red");
  }
  EXPECT_THROW(file.pose({.variant = "Green"}, std::move(scene)), Error);
}

} // namespace
} // namespace wavepath
