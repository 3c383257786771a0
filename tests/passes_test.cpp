// Passes: what passes through the centre of a pixel, and which fraction of its samples sees what.
#include "host/passes/passes.h"

#include <array>
#include <bit>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

#include "host/passes/cryptomatte.h"
#include "host/render/settings/denoising.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/workspace/workspace.h"
#include "tests/shadow_scene.h"

namespace wavepath::test {
namespace {

// Published values of the function.
TEST(Cryptomatte, HashesNamesAsItsSpecificationSays) {
  EXPECT_EQ(murmur_hash(""), 0u);
  EXPECT_EQ(murmur_hash("hello"), 0x248bfa47u);
  EXPECT_EQ(murmur_hash("hello, world"), 0x149bbb7fu);
  EXPECT_EQ(murmur_hash("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
}

// Ids stand in channels of floats, which programs may touch: they are finite, and no denormals.
TEST(Cryptomatte, IdsAreNormalFloats) {
  for (int i = 0; i < 20000; ++i) {
    const std::string name = fmt::format("body {}", i);
    ASSERT_TRUE(std::isnormal(cryptomatte_id(name))) << name;
    const std::uint32_t changed = std::bit_cast<std::uint32_t>(cryptomatte_id(name)) ^ murmur_hash(name);
    ASSERT_TRUE(changed == 0 || changed == 1u << 23);
  }
}

constexpr std::uint32_t kWidth = 40, kHeight = 24;

std::string text_of(const Picture& picture, const std::string& name) {
  const auto found = std::ranges::find(picture.texts, name, &std::pair<std::string, std::string>::first);
  EXPECT_NE(found, picture.texts.end()) << name;
  return found == picture.texts.end() ? "" : found->second;
}

class PassesTest : public VulkanTest {
protected:
  RenderPlan settings(std::vector<std::string> passes, std::uint32_t samples = 8) {
    RenderPlan settings;
    settings.integrator = find_integrator("path");
    settings.width = kWidth, settings.height = kHeight;
    settings.last_sample = samples;
    settings.aovs = std::move(passes);
    return settings;
  }

  Picture passes(Scene scene, const RenderPlan& settings) {
    const View view = resolve_view(scene, {}, settings.width, settings.height);
    packed_ = pack(scene, {.direct = settings.direct});
    SceneOnDevice shared;
    Picture picture{settings.width, settings.height, {}};
    EXPECT_TRUE(add_passes(
        device(), packed_, view, settings, motion_, shared_kernels(device()), shared, [] { return true; }, picture));
    return picture;
  }

  PackedScene packed_;
  MotionPictures motion_;
};

// Seen from above, over nothing: a tilted square; two that share a mesh, one of them mirrored; one without a name.
Scene tiles() {
  Scene scene;
  scene.path = "test";
  scene.materials = {plain_material(), plain_material()};
  scene.materials[0].name = "clay", scene.materials[1].name = "chalk";
  scene.node_names = {"root", "tilted", "left", "right", ""};
  const auto add = [&](std::uint32_t mesh, std::uint32_t node, const glm::dmat4& transform = glm::dmat4(1.0)) {
    add_instance(scene, mesh, transform);
    scene.instances.back().node = node;
  };
  const std::uint32_t two = add_mesh(scene, rectangle({0, 0, 0}, {0, 0, 0.2f}, {0.2f, 0, 0}), 1);
  add(add_mesh(scene, rectangle({0, 0, -0.4f}, {0, 0, 0.15f}, {0.7f, 0.35f, 0})), 1);
  add(two, 2, glm::translate(glm::dmat4(1.0), {-0.6, 0.1, 0.3}));
  add(two, 3, glm::scale(glm::translate(glm::dmat4(1.0), {0.6, 0.2, 0.3}), {-1.0, 1.0, 1.0}));
  add(add_mesh(scene, rectangle({0, 0.3f, 0.3f}, {0, 0, 0.2f}, {0.2f, 0, 0})), 4);
  scene.cameras.push_back(camera_above({0, 0, 0}, 0.6));
  return scene;
}

// What the centre of a pixel shows: a node of tiles(), or -1.
int expected_node(double x, double z) {
  if (std::abs(z + 0.4) < 0.15 && std::abs(x) < 0.7) return 1;
  if (std::abs(z - 0.3) >= 0.2) return -1;
  return std::abs(x + 0.6) < 0.2 ? 2 : std::abs(x - 0.6) < 0.2 ? 3 : std::abs(x) < 0.2 ? 4 : -1;
}

TEST_F(PassesTest, ShowWhatPassesThroughTheCentreOfAPixel) {
  const Scene scene = tiles();
  const Picture picture = passes(scene, settings({"node", "material", "depth0", "normal0", "position0", "geometric"}));
  const double half_width = 0.6 * kWidth / kHeight; // the picture is wider than the camera is high
  const auto &node = channel(picture, "id.node"), &material = channel(picture, "id.material"),
             &depth = channel(picture, "Z0"), &px = channel(picture, "P0.X"), &pz = channel(picture, "P0.Z");
  const double slope = std::hypot(1.0, 0.5);
  std::array<int, 6> counts{};
  for (std::uint32_t i = 0; i < node.size(); ++i) {
    const double x = ((i % kWidth + 0.5) / kWidth * 2.0 - 1.0) * half_width,
                 z = ((i / kWidth + 0.5) / kHeight * 2.0 - 1.0) * 0.6;
    const int expected = expected_node(x, z);
    ++counts[static_cast<std::size_t>(expected + 1)];
    ASSERT_EQ(node[i], static_cast<float>(expected)) << x << " " << z;
    if (expected < 0) {
      ASSERT_EQ(material[i], -1.0f);
      ASSERT_EQ(depth[i], 1e10f);
      continue;
    }
    ASSERT_EQ(packed_.material_names[static_cast<std::size_t>(material[i])],
              expected == 2 || expected == 3 ? "chalk" : "clay");
    const double height[] = {0.0, 0.5 * x, 0.1, 0.2, 0.3};
    ASSERT_NEAR(depth[i], 3.0 - height[expected], 1e-5);
    ASSERT_NEAR(px[i], x, 1e-5);
    ASSERT_NEAR(pz[i], z, 1e-5);
    for (const char* prefix : {"N0", "Ng"}) {
      const std::string name = prefix;
      ASSERT_NEAR(channel(picture, name + ".X")[i], expected == 1 ? -0.5 / slope : 0.0, 1e-5) << prefix;
      ASSERT_NEAR(channel(picture, name + ".Y")[i], expected == 1 ? 1.0 / slope : 1.0, 1e-5) << prefix;
      ASSERT_NEAR(channel(picture, name + ".Z")[i], 0.0, 1e-5) << prefix;
    }
  }
  for (const std::size_t shown : {0, 2, 3, 4, 5}) EXPECT_GT(counts[shown], 20) << shown;
  const auto names = nlohmann::json::parse(text_of(picture, "wavepath.nodes"));
  EXPECT_EQ(names, (nlohmann::json{{"1", "tilted"}, {"2", "left"}, {"3", "right"}, {"4", "node 4"}}));
}

// By lens and filter, pixels around an edge see both sides of it; through their centres they see one.
TEST_F(PassesTest, LensAndFilterDoNotReachThem) {
  RenderPlan blurred = settings({"node", "depth0"});
  const Picture sharp = passes(tiles(), blurred);
  blurred.lens.aperture = 0.5;
  blurred.filter = gpu::kFilterGaussian;
  blurred.seed = 7;
  EXPECT_EQ(channel(sharp, "id.node"), channel(passes(tiles(), blurred), "id.node"));
  EXPECT_EQ(channel(sharp, "Z0"), channel(passes(tiles(), blurred), "Z0"));
}

// Coordinates are packed where a texture reads them.
TEST_F(PassesTest, TellTextureCoordinates) {
  Scene scene = tiles();
  Image image{.name = "white", .width = 1, .height = 1};
  image.bytes = {255, 255, 255, 255};
  scene.images.push_back(image);
  scene.materials[0].base_color_texture.image = 0;
  Mesh& tilted = scene.meshes[1];
  for (const glm::vec3& p : tilted.positions) tilted.uvs[0].push_back({p.x, 2.0f * p.z});
  for (Mesh& mesh : scene.meshes)
    if (mesh.uvs[0].empty()) mesh.uvs[0].resize(mesh.positions.size());
  const Picture picture = passes(scene, settings({"uv", "position0", "node"}));
  int seen = 0;
  for (std::size_t i = 0; i < kWidth * kHeight; ++i) {
    if (channel(picture, "id.node")[i] != 1.0f) continue;
    ++seen;
    ASSERT_NEAR(channel(picture, "uv.X")[i], channel(picture, "P0.X")[i], 1e-5);
    ASSERT_NEAR(channel(picture, "uv.Y")[i], 2.0f * channel(picture, "P0.Z")[i], 1e-5);
  }
  EXPECT_GT(seen, 20);
}

// Samples of every pixel by name, from the channels: whole numbers, of which none is counted twice.
std::vector<std::map<std::string, double>> decode(const Picture& picture, const std::string& layer,
                                                  const std::vector<std::string>& names, std::uint32_t samples) {
  std::vector<std::map<std::string, double>> decoded(std::size_t{picture.width} * picture.height);
  for (std::size_t i = 0; i < decoded.size(); ++i) {
    double before = 2.0;
    for (int level = 0; level < 6; ++level) {
      const std::string base = fmt::format("{}{:02}.", layer, level / 2);
      const float id = channel(picture, base + (level % 2 ? "B" : "R"))[i],
                  coverage = channel(picture, base + (level % 2 ? "A" : "G"))[i];
      EXPECT_LE(coverage, before);
      before = coverage;
      if (coverage == 0.0f) continue;
      const auto name = std::ranges::find_if(names, [&](const std::string& n) { return cryptomatte_id(n) == id; });
      EXPECT_NE(name, names.end());
      if (name == names.end()) continue;
      EXPECT_NEAR(coverage * samples, std::round(coverage * samples), 1e-4);
      EXPECT_TRUE(decoded[i].emplace(*name, coverage).second) << *name;
    }
  }
  return decoded;
}

const std::vector<std::string> kTileNames{"tilted", "left", "right", "node 4"};

// A box filter over an orthographic view: the fraction of a pixel that a square covers, which stratified samples meet
// to within two of them along an edge.
TEST_F(PassesTest, CoveragesAreTheFractionsOfSamples) {
  constexpr std::uint32_t kSamples = 256;
  RenderPlan plan = settings({"cryptomatte"}, kSamples);
  plan.filter = gpu::kFilterBox;
  const Picture picture = passes(tiles(), plan);
  const auto decoded = decode(picture, "CryptoObject", kTileNames, kSamples);
  const double half_width = 0.6 * kWidth / kHeight, pixel = 2.0 * half_width / kWidth;
  const auto overlap = [&](double centre, double lo, double hi) { // of a pixel with an interval, as a fraction
    return std::max(0.0, std::min(centre + 0.5 * pixel, hi) - std::max(centre - 0.5 * pixel, lo)) / pixel;
  };
  const struct {
    const char* name;
    double x0, x1, z0, z1;
  } squares[] = {{"tilted", -0.7, 0.7, -0.55, -0.25},
                 {"left", -0.8, -0.4, 0.1, 0.5},
                 {"right", 0.4, 0.8, 0.1, 0.5},
                 {"node 4", -0.2, 0.2, 0.1, 0.5}};
  for (std::size_t i = 0; i < decoded.size(); ++i) {
    const double x = ((static_cast<double>(i % kWidth) + 0.5) / kWidth * 2.0 - 1.0) * half_width,
                 z = ((static_cast<double>(i / kWidth) + 0.5) / kHeight * 2.0 - 1.0) * 0.6;
    for (const auto& square : squares) {
      const double exact = overlap(x, square.x0, square.x1) * overlap(z, square.z0, square.z1);
      const auto found = decoded[i].find(square.name);
      ASSERT_NEAR(found == decoded[i].end() ? 0.0 : found->second, exact, 0.02)
          << square.name << " at " << x << " " << z;
    }
  }
  for (const std::string layer : {"CryptoObject", "CryptoMaterial"}) {
    const std::vector<std::string> texts = cryptomatte_texts(layer);
    EXPECT_EQ(text_of(picture, texts[0]), layer);
    EXPECT_EQ(text_of(picture, texts[1]), "MurmurHash3_32");
    EXPECT_EQ(text_of(picture, texts[2]), "uint32_to_float32");
  }
  const auto manifest = nlohmann::json::parse(text_of(picture, cryptomatte_texts("CryptoObject")[3]));
  EXPECT_EQ(manifest.at("tilted").get<std::string>(),
            fmt::format("{:08x}", std::bit_cast<std::uint32_t>(cryptomatte_id("tilted"))));
  // Two squares of one material count as one.
  const auto materials = decode(picture, "CryptoMaterial", {"clay", "chalk"}, kSamples);
  for (std::size_t i = 0; i < decoded.size(); ++i) {
    double clay = 0.0;
    for (const char* name : {"tilted", "node 4"})
      if (decoded[i].contains(name)) clay += decoded[i].at(name);
    ASSERT_NEAR(materials[i].contains("clay") ? materials[i].at("clay") : 0.0, clay, 1e-6);
  }
}

TEST_F(PassesTest, PartsJoinToTheWhole) {
  const RenderPlan whole = settings({"cryptomatte", "node", "depth0", "depth_min"}, 24);
  RenderPlan first = whole, second = whole;
  first.last_sample = second.first_sample = 8;
  first.sample_total = second.sample_total = 24;
  const Picture expected = passes(tiles(), whole), a = passes(tiles(), first), b = passes(tiles(), second);
  Picture joined{kWidth, kHeight, {}};
  JoinedPasses parts;
  join_passes(parts, a, 8);
  join_passes(parts, b, 16);
  add_passes(parts, joined);
  ASSERT_EQ(joined.channels.size(), expected.channels.size());
  for (const Channel& one : expected.channels) EXPECT_EQ(channel(joined, one.name), one.values) << one.name;
  EXPECT_NE(channel(a, "CryptoObject00.G"), channel(b, "CryptoObject00.G"));
  EXPECT_NE(channel(a, "Zmin"), channel(b, "Zmin"));
  // The tilted square is higher to one side: its nearest point in a pixel is nearer than that at the centre.
  std::size_t nearer = 0;
  for (std::size_t i = 0; i < channel(expected, "Z0").size(); ++i) {
    if (channel(expected, "Z0")[i] > 1e9f) continue;
    nearer += channel(expected, "Zmin")[i] < channel(expected, "Z0")[i] ? 1 : 0;
    EXPECT_LE(channel(expected, "Zmin")[i], channel(expected, "Z0")[i] + 0.02f);
  }
  EXPECT_GT(nearer, 20u);
}

// What was asked of passes alone leaves the picture and its film as they are.
TEST_F(PassesTest, CostTheSamplesNothing) {
  RenderPlan plain = settings({}), with = settings({"node", "cryptomatte", "normal0"});
  EXPECT_FALSE(records_aovs(with));
  EXPECT_EQ(film_shape(plain), film_shape(with));
}

} // namespace
} // namespace wavepath::test
