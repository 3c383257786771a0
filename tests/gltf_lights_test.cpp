// glTF import: luminaires (EXT_lights_ies) and image-based lights (EXT_lights_image_based).
#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/codecs/png.h"
#include "host/scene/gltf/image_light.h"
#include "host/scene/ies.h"
#include "host/scene/lat_long.h"
#include "host/scene/pack/pack.h"
#include "tests/gltf_checks.h"

namespace wavepath {
namespace {

using nlohmann::json;
using test::expect_near;
using test::GltfBuilder;
using test::load;
using test::warning_count;

constexpr double kPi = std::numbers::pi;

struct Table {
  std::string version = "IESNA:LM-63-2002", tilt = "NONE";
  double multiplier = 1.0, ballast = 1.0, reserved = 1.0;
  int type = 1;
  std::vector<double> vertical = {0, 45, 90}, horizontal = {0}, candela = {100, 50, 0};

  std::string text() const {
    const auto list = [](const std::vector<double>& values) {
      std::string line;
      for (const double value : values) line += std::to_string(value) + " ";
      return line + "\r\n";
    };
    return version + "\r\n[MANUFAC] none\r\nTILT=" + tilt + "\r\n1 1000 " + std::to_string(multiplier) + " " +
           std::to_string(vertical.size()) + " " + std::to_string(horizontal.size()) + " " + std::to_string(type) +
           " 2 0.1 0.2 0\r\n" + std::to_string(ballast) + " " + std::to_string(reserved) + " 10\r\n" + list(vertical) +
           list(horizontal) + list(candela);
  }
  IesFile read() const { return read_ies("file", "profile", text()); }
  std::string problem() const {
    try {
      read();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
};

TEST(Ies, VersionsAndFactors) {
  Table table;
  table.multiplier = 2.0, table.ballast = 0.5, table.reserved = 0.25;
  for (const char* version : {"IESNA:LM-63-1995", "IESNA:LM-63-2002", "IES:LM-63-2019"}) {
    table.version = version;
    const IesFile file = table.read();
    EXPECT_EQ(file.candela, 100.0) << version;
    EXPECT_EQ(file.profile.intensities, (std::vector<float>{1.0f, 0.5f, 0.0f}));
    EXPECT_EQ(file.profile.horizontal.size(), 1u);
    EXPECT_NEAR(file.profile.vertical[1], kPi / 4, 1e-7);
  }
  table.version = "IESNA91";
  EXPECT_EQ(table.read().candela, 25.0);
  table.tilt = "INCLUDE\r\n1\r\n3\r\n0 90 180\r\n1 0.9 0.8";
  EXPECT_EQ(table.read().candela, 25.0);
  table.tilt = "lamp.tlt";
  EXPECT_EQ(table.read().candela, 25.0);
}

TEST(Ies, WhatSymmetryLeavesOutIsFilledIn) {
  const auto columns = [](const std::vector<double>& horizontal) {
    Table table;
    table.vertical = {0, 90};
    table.horizontal = horizontal;
    table.candela.clear();
    for (const double h : horizontal) table.candela.insert(table.candela.end(), {400.0, 10.0 + h});
    const LightProfile profile = table.read().profile;
    std::vector<std::pair<double, double>> found; // degrees, the angle of the file
    for (std::size_t i = 0; i < profile.horizontal.size(); ++i)
      found.emplace_back(std::round(profile.horizontal[i] * 180.0 / kPi),
                         std::round(400.0 * profile.intensities[2 * i + 1] - 10.0));
    return found;
  };
  using Columns = std::vector<std::pair<double, double>>;
  EXPECT_EQ(columns({0, 30, 90}),
            (Columns{{0, 0}, {30, 30}, {90, 90}, {150, 30}, {180, 0}, {210, 30}, {270, 90}, {330, 30}, {360, 0}}));
  EXPECT_EQ(columns({0, 60, 180}), (Columns{{0, 0}, {60, 60}, {180, 180}, {300, 60}, {360, 0}}));
  EXPECT_EQ(columns({90, 180, 270}), (Columns{{0, 180}, {90, 90}, {180, 180}, {270, 270}, {360, 180}}));
  EXPECT_EQ(columns({90, 120, 270}), (Columns{{-90, 270}, {60, 120}, {90, 90}, {120, 120}, {270, 270}, {420, 120}}));
  EXPECT_EQ(columns({0, 120, 240, 360}), (Columns{{0, 0}, {120, 120}, {240, 240}, {360, 360}}));
  EXPECT_EQ(columns({0, 120, 240}), (Columns{{0, 0}, {120, 120}, {240, 240}, {360, 0}}));
}

TEST(Ies, WhatIsNotSoundIsRefused) {
  EXPECT_NE((Table{.candela = {1, 2}}).problem().find("no candela value"), std::string::npos);
  EXPECT_NE((Table{.vertical = {0, 45, 45}}).problem().find("do not ascend"), std::string::npos);
  EXPECT_NE((Table{.candela = {1, -2, 0}}).problem().find("below 0"), std::string::npos);
  EXPECT_NE((Table{.vertical = {-10, 45, 90}}).problem().find("type C cannot"), std::string::npos);
  EXPECT_NE((Table{.horizontal = {10, 20}, .candela = {1, 1, 1, 1, 1, 1}}).problem().find("from 10"),
            std::string::npos);
  EXPECT_THROW(read_ies("file", "profile", "hello"), Error);
  EXPECT_THROW(read_ies("file", "profile", ""), Error);
  EXPECT_THROW(read_ies("file", "profile", "IES:LM-63-2019\nTILT=NONE\n1 1 1 1e9 1e9 1 1 0 0 0 1 1 1"), Error);
  EXPECT_EQ(Table{.type = 2}.read().type, 'B');
  EXPECT_EQ(Table{.type = 3}.read().type, 'A');
}

// ---- EXT_lights_ies

GltfBuilder with_luminaire(const Table& table) {
  GltfBuilder b = GltfBuilder::triangle();
  b.root["extensionsUsed"] = {"EXT_lights_ies"};
  b.root["extensionsRequired"] = {"EXT_lights_ies"};
  b.root["extensions"]["EXT_lights_ies"]["lights"] = {
      {{"uri", "data:application/x-ies-lm-63;base64," + GltfBuilder::base64(table.text())}, {"name", "lamp"}}};
  b.add("nodes", {{"translation", {1, 2, 3}}, {"extensions", {{"EXT_lights_ies", {{"light", 0}}}}}});
  return b;
}

TEST(GltfIes, LampsOfNodes) {
  GltfBuilder b = with_luminaire({});
  b.root["nodes"][1]["extensions"]["EXT_lights_ies"]["multiplier"] = 3;
  b.root["nodes"][1]["extensions"]["EXT_lights_ies"]["color"] = {1, 0.5, 0};
  const double h = std::sqrt(0.5);
  b.root["nodes"][1]["rotation"] = {-h, 0, 0, h}; // -Z to -Y
  b.root["nodes"][1]["scale"] = {2, 3, 4};
  b.add("nodes", {{"children", {1}}}); // without a scene, all roots
  const Scene scene = load(b);
  EXPECT_TRUE(scene.warnings.empty());
  ASSERT_EQ(scene.lights.size(), 1u);
  ASSERT_EQ(scene.profiles.size(), 1u);
  const PunctualLight& light = scene.lights[0];
  EXPECT_EQ(light.intensity, glm::vec3(300, 150, 0));
  EXPECT_EQ(light.kind, LightKind::point);
  EXPECT_EQ(light.profile, 0u);
  EXPECT_EQ(light.name, "lamp");
  expect_near(light.position, {1, 2, 3});
  expect_near(light.direction, {0, -1, 0});
  expect_near(light.tangent, {1, 0, 0});
  b.root["nodes"][1]["extensions"]["EXT_lights_ies"]["color"] = {2, 0.5, 0};
  EXPECT_EQ(warning_count(load(b), "IES lamp outside its range"), 1u);
  b.root["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"] = false;
  EXPECT_TRUE(load(b).lights.empty());
}

TEST(GltfIes, ProfilesInBufferViewsAndOfOtherTypes) {
  GltfBuilder b = with_luminaire({});
  const int view = b.view(Table{}.text());
  b.root["extensions"]["EXT_lights_ies"]["lights"][0] = {{"bufferView", view}, {"mimeType", "application/x-ies-lm-63"}};
  EXPECT_EQ(load(b).lights.at(0).intensity.x, 100.0f);
  const Scene other = load(with_luminaire({.type = 2}));
  EXPECT_TRUE(other.lights.empty());
  EXPECT_EQ(warning_count(other, "photometry of type B"), 1u);
  b.root["extensions"]["EXT_lights_ies"]["lights"][0] = {{"uri", "../lamp.ies"}};
  EXPECT_THROW(load(b), Error);
}

// Lamps are picked by the light that they send: the integral of the profile.
TEST(GltfIes, PowerIsTheIntegralOfTheProfile) {
  const auto probability = [](const Table& table) {
    Scene scene = load(with_luminaire(table));
    PunctualLight point = scene.lights.at(0);
    point.profile = kNoIndex;
    point.intensity = glm::vec3(1.0f);
    scene.lights.push_back(point); // of 4 pi
    const PackedScene packed = pack(scene, {});
    EXPECT_EQ(packed.features & gpu::kFeatureLightProfiles, gpu::kFeatureLightProfiles);
    return double{packed.lights.at(0).probability} / packed.lights.at(1).probability;
  };
  // 1 cd all over; a hemisphere; a linear slope, whose integral times the sine is 1 - sin(pi/2)/(pi/2).
  EXPECT_NEAR(probability({.vertical = {0, 180}, .candela = {1, 1}}), 1.0, 1e-5);
  EXPECT_NEAR(probability({.vertical = {0, 90}, .candela = {1, 1}}), 0.5, 1e-5);
  EXPECT_NEAR(probability({.vertical = {0, 90}, .candela = {1, 0}}), 0.5 * (1.0 - 2.0 / kPi), 1e-5);
  EXPECT_NEAR(probability({.vertical = {0, 180}, .horizontal = {0, 90}, .candela = {1, 1, 0, 0}}), 0.5, 1e-5);
  EXPECT_NEAR(probability({.vertical = {0, 180}, .horizontal = {90, 120, 270}, .candela = {1, 1, 0, 0, 1, 1}}),
              (30.0 + 150.0 / 2 + 150.0 / 2) / 360.0, 1e-5); // slopes: 90 to 120 and 120 to 270, twice
  Scene plain = load(with_luminaire({}));
  plain.lights[0].profile = kNoIndex;
  EXPECT_EQ(pack(plain, {}).features & gpu::kFeatureLightProfiles, 0u);
}

// ---- EXT_lights_image_based

// Faces of one colour each, as PNG of four channels (RGBD).
GltfBuilder with_cube() {
  GltfBuilder b = GltfBuilder::triangle();
  json level = json::array();
  for (int face = 0; face < 6; ++face) {
    std::vector<std::uint8_t> texels;
    for (int i = 0; i < 4; ++i)
      texels.insert(texels.end(), {static_cast<std::uint8_t>(40 * (face + 1)), 255, 0, 51}); // divided by 1/5
    DecodedImage image;
    image.shape = {2, 2, 4};
    image.bytes = texels;
    const std::vector<std::uint8_t> png = encode_png(image);
    level.push_back(b.add("images", {{"bufferView", b.view(std::string(png.begin(), png.end()))}}));
  }
  b.root["extensions"]["EXT_lights_image_based"]["lights"] = {{{"intensity", 2},
                                                               {"specularImages", {level}},
                                                               {"specularImageSize", 2},
                                                               {"irradianceCoefficients", json::array()}}};
  b.root["scenes"] = {{{"nodes", {0}}, {"extensions", {{"EXT_lights_image_based", {{"light", 0}}}}}}};
  b.root["extensionsUsed"] = {"EXT_lights_image_based"};
  return b;
}

glm::vec3 seen(const Environment& environment, const glm::dvec3& direction) {
  const glm::dvec2 uv = environment_uv(direction, environment.rotation);
  const auto x = static_cast<std::size_t>(uv.x * environment.width),
             y = static_cast<std::size_t>(uv.y * environment.height);
  return environment.radiance * environment.map.at(y * environment.width + x);
}

constexpr glm::dvec3 kFaceDirections[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

TEST(GltfImageLight, FacesAndIntensity) {
  const Environment environment = load(with_cube()).environment;
  ASSERT_TRUE(environment.present());
  EXPECT_EQ(environment.width, 8u);
  for (int face = 0; face < 6; ++face) {
    const double stored = 40.0 * (face + 1) / 255.0, linear = std::pow((stored + 0.055) / 1.055, 2.4);
    const glm::dvec3 direction = kFaceDirections[face] + glm::dvec3(0.01, 0.013, 0.017);
    expect_near(seen(environment, direction), glm::dvec3(2 * 5 * linear, 2 * 5, 0), 2e-4 * 10);
  }
  GltfBuilder b = with_cube();
  const double h = std::sqrt(0.5);
  b.root["extensions"]["EXT_lights_image_based"]["lights"][0]["rotation"] = {0, h, 0, h}; // +Z to +X
  const Environment turned = load(b).environment;
  expect_near(seen(turned, {1, 0.01, 0.01}), seen(environment, {-0.01, 0.01, 1}));
  b.root["scenes"][0].erase("extensions");
  EXPECT_FALSE(load(b).environment.present());
}

// Corners of faces, as they are seen from the middle of a right-handed space.
TEST(GltfImageLight, Orientation) {
  constexpr std::uint32_t kSize = 32;
  const glm::dvec3 right[6] = {{0, 0, 1}, {0, 0, -1}, {-1, 0, 0}, {-1, 0, 0}, {-1, 0, 0}, {1, 0, 0}};
  const glm::dvec3 up[6] = {{0, 1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}, {0, 1, 0}, {0, 1, 0}};
  for (std::size_t face = 0; face < 6; ++face) {
    std::vector<std::vector<glm::vec3>> faces(6, std::vector<glm::vec3>(kSize * kSize, glm::vec3(0.0f)));
    for (std::uint32_t y = kSize / 2; y < kSize; ++y) // its upper right quarter, turned by half a turn
      for (std::uint32_t x = 0; x < kSize / 2; ++x) faces[face][y * kSize + x] = glm::vec3(1.0f);
    const Environment environment = gltf::environment_of_cube(faces, kSize, glm::dmat3(1.0));
    const auto at = [&](double x, double y) {
      return seen(environment, kFaceDirections[face] + x * right[face] + y * up[face]).x;
    };
    EXPECT_EQ(at(0.5, 0.5), 1.0f) << face;
    EXPECT_EQ(at(-0.5, 0.5), 0.0f) << face;
    EXPECT_EQ(at(0.5, -0.5), 0.0f) << face;
    EXPECT_NEAR(glm::dot(glm::cross(kFaceDirections[face], up[face]), right[face]), 1.0, 1e-12);
  }
}

TEST(GltfImageLight, WhatIsNotSoundIsRefused) {
  GltfBuilder b = with_cube();
  json& light = b.root["extensions"]["EXT_lights_image_based"]["lights"][0];
  light["specularImages"][0].erase(5);
  EXPECT_THROW(load(b), Error);
  light["specularImages"] = json::array();
  EXPECT_THROW(load(b), Error);
  b = with_cube();
  b.root["scenes"][0]["extensions"]["EXT_lights_image_based"]["light"] = 1;
  EXPECT_THROW(load(b), Error);
}

} // namespace
} // namespace wavepath
