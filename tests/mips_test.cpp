// Mip levels of textures: the host's averages, what frames of one sample make of them, and that nobody else has them.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "host/film/film.h"
#include "host/integrators/hybrid/kind.h"
#include "host/integrators/path/kind.h"
#include "host/render/render.h"
#include "host/render/settings/mips.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/mips.h"
#include "host/scene/pack/pack.h"
#include "host/scene/pack/plan.h"
#include "host/scene/pack/textures.h"
#include "host/scene/staging/view.h"
#include "kernels/base/tile_order.h"
#include "tests/probe.h"
#include "tests/scene_builder.h"
#include "tests/shared_kernels.h"
#include "tests/statistics.h"

namespace wavepath::test {
namespace {

Image bytes_image(std::uint32_t width, std::uint32_t height, auto&& value) {
  Image image{"bytes", width, height, {}, {}};
  for (std::uint32_t i = 0; i < 4 * width * height; ++i) image.bytes.push_back(static_cast<std::uint8_t>(value(i)));
  return image;
}

// A packed texture at one of its levels, linear.
struct LevelReader {
  gpu::Texture texture{};
  std::vector<std::uint32_t> words;

  LevelReader(const Image& image, MipKind kind) : words(mip_words(image)) {
    texture.flags = kind.srgb && image.floats.empty() ? gpu::kTextureSrgb : 0;
    if (!image.floats.empty()) texture.flags |= gpu::kTextureFloat;
    texture.width = image.width, texture.height = image.height;
    store_mips(image, kind, words.data());
  }
  std::vector<glm::vec4> level(std::uint32_t level) const {
    gpu::Texture at = texture;
    for (std::uint32_t i = 1; i < level; ++i)
      at.first_texel += gpu::texel_count(gpu::mip_size(at.width, i), gpu::mip_size(at.height, i), 0) *
                        (at.flags & gpu::kTextureFloat ? 4 : 1);
    at.width = gpu::mip_size(texture.width, level), at.height = gpu::mip_size(texture.height, level);
    std::vector<glm::vec4> texels;
    for (std::uint32_t y = 0; y < at.height; ++y)
      for (std::uint32_t x = 0; x < at.width; ++x) texels.push_back(read_texel(at, words, x, y));
    return texels;
  }
};

glm::dvec4 mean_of(const std::vector<glm::vec4>& texels) {
  glm::dvec4 sum(0.0);
  for (const glm::vec4& texel : texels) sum += texel;
  return sum / static_cast<double>(texels.size());
}

TEST(MipChain, HalvesDownToOneTexel) {
  EXPECT_EQ(mip_count(1, 1), 0u);
  EXPECT_EQ(mip_count(13, 7), 3u);
  EXPECT_EQ(mip_texels(13, 7), 2u * 16 + 16 + 16); // levels of 6x3, 3x1 and 1x1, in tiles of 4x4
  EXPECT_EQ(gpu::mip_size(13, 2), 3u);
  EXPECT_EQ(gpu::mip_size(7, 3), 1u);
}

TEST(MipChain, AConstantStaysWhatItIs) {
  for (const bool srgb : {false, true})
    for (int byte = 0; byte < 256; ++byte) {
      const Image image = bytes_image(13, 7, [&](std::uint32_t) { return byte; });
      std::vector<std::uint32_t> words(mip_words(image));
      store_mips(image, {.srgb = srgb}, words.data());
      const std::uint32_t expected = 0x01010101u * static_cast<std::uint32_t>(byte);
      EXPECT_EQ(words[0], expected) << srgb;
      EXPECT_EQ(words.rbegin()[15], expected) << srgb; // the last level's one texel
    }
}

// Of light, not of bytes; where the sizes are odd, too.
TEST(MipChain, KeepsTheMean) {
  std::mt19937 random(1);
  for (const auto& [width, height] : std::vector<std::pair<std::uint32_t, std::uint32_t>>{{16, 16}, {13, 7}, {1, 9}}) {
    Image image{"floats", width, height, {}, {}};
    for (std::uint32_t i = 0; i < 4 * width * height; ++i)
      image.floats.push_back(std::uniform_real_distribution<float>(0.0f, 4.0f)(random));
    const LevelReader chain(image, {});
    glm::dvec4 expected(0.0);
    for (std::size_t i = 0; i < image.floats.size(); ++i) expected[static_cast<int>(i % 4)] += image.floats[i];
    expected /= width * height;
    for (std::uint32_t level = 1; level <= mip_count(width, height); ++level) {
      const glm::dvec4 mean = mean_of(chain.level(level));
      for (int c = 0; c < 4; ++c) EXPECT_NEAR(mean[c], expected[c], 1e-5) << width << "x" << height << ", " << level;
    }
  }
}

TEST(MipChain, AveragesLightWhereBytesAreEncoded) {
  const Image checks = bytes_image(8, 8, [](std::uint32_t i) { return (i / 4 + i / 32) % 2 ? 255 : 0; });
  for (std::uint32_t level = 1; level <= 3; ++level)
    EXPECT_NEAR(mean_of(LevelReader(checks, {.srgb = true}).level(level)).r, 0.5, 0.005); // half a byte of sRGB
  EXPECT_EQ(LevelReader(checks, {.srgb = true}).level(3)[0].a, 128.0f / 255.0f);
}

TEST(MipChain, SeeThroughColoursDoNotBleed) {
  // Opaque green leaves beside see-through white.
  const Image leaves = bytes_image(8, 8, [](std::uint32_t i) {
    const bool leaf = i / 4 % 2 == 0;
    return i % 4 == 3 ? (leaf ? 255 : 0) : leaf ? (i % 4 == 1 ? 255 : 0) : 255;
  });
  const glm::vec4 weighed = LevelReader(leaves, {.covers = true}).level(3)[0];
  const glm::vec4 plain = LevelReader(leaves, {}).level(3)[0];
  EXPECT_LT(weighed.r, 0.01f);
  EXPECT_EQ(weighed.g, 1.0f);
  EXPECT_EQ(weighed.a, plain.a);
  EXPECT_NEAR(plain.r, 0.5f, 0.01f);
}

// Normals that spread make a short vector, which is what they contribute where texels are blended.
TEST(MipChain, NormalsAreAveragedAsVectors) {
  const Image bumps = bytes_image(4, 4, [](std::uint32_t i) { return i % 4 == 0 ? (i / 4 % 2 ? 255 : 0) : 128; });
  const glm::vec4 texel = LevelReader(bumps, {}).level(2)[0];
  EXPECT_NEAR(texel.r, 0.5f, 0.005f);
}

// A floor of 200 x 200 squares of black and white, seen from above, under a white sky.
Scene checkered_floor() {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  Image image = bytes_image(8, 8, [](std::uint32_t i) { return i % 4 == 3 || (i / 4 + i / 32) % 2 ? 255 : 0; });
  scene.images.push_back(image);
  scene.materials[0].base_color = glm::vec4(1.0f);
  scene.materials[0].base_color_texture.image = 0;
  scene.materials[0].base_color_texture.srgb = true;
  const float s = 100.0f;
  add_instance(scene, add_mesh(scene, {{-s, 0, s}, {s, 0, s}, {s, 0, -s}, {-s, 0, s}, {s, 0, -s}, {-s, 0, -s}}));
  const float r = 25.0f; // the image's repetitions
  scene.meshes[0].uvs[0] = {{0, 0}, {r, 0}, {r, r}, {0, 0}, {r, r}, {0, r}};
  scene.environment.radiance = glm::vec3(1.0f);
  Camera camera;
  camera.world_from_camera = {{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, {0, 400, 0, 1}}; // looks along -y
  camera.yfov = 0.43;
  scene.cameras.push_back(camera);
  return scene;
}

class MipFrames : public VulkanTest {
protected:
  static RenderPlan settings(const IntegratorKind* integrator, std::uint32_t spp) {
    RenderPlan settings;
    settings.width = settings.height = 32;
    settings.last_sample = spp;
    settings.max_depth = 1;
    settings.shadow_samples = 64;
    settings.integrator = integrator;
    return settings;
  }
  RenderResult render(Scene scene, const RenderPlan& settings, bool mips) {
    const View view = resolve_view(scene, {}, settings.width, settings.height);
    const PackedScene packed = pack(scene, {.mips = mips});
    return wavepath::render(device(), packed, view, settings, RenderHooks{}, shared_kernels(device()));
  }
};

TEST_F(MipFrames, DistantChecksAreGrey) {
  RenderPlan with = settings(&kHybrid, 1), without = with;
  without.mips = false;
  const auto spread = [&](const RenderPlan& settings) {
    Mean mean;
    const RenderResult result = render(checkered_floor(), settings, true);
    for (const float value : result.picture.channels[0].values) mean.add(value);
    EXPECT_NEAR(mean.mean(), 0.5, 0.1);
    return mean.error();
  };
  // A pixel sees 30 squares; look-ups of one square are black or white.
  EXPECT_LT(spread(with), 0.1 * spread(without));
}

TEST_F(MipFrames, APixelThatSeesOneTexelLooksItUpExactly) {
  Scene scene = checkered_floor();
  scene.cameras[0].yfov = 0.002; // a pixel is a fortieth of a square
  const RenderPlan one = settings(&kHybrid, 1);
  EXPECT_TRUE(*render(scene, one, true).film == *render(scene, one, false).film);
}

TEST_F(MipFrames, MoreSamplesAreExact) {
  const RenderPlan two = settings(&kHybrid, 2), one = settings(&kHybrid, 1);
  EXPECT_TRUE(*render(checkered_floor(), two, true).film == *render(checkered_floor(), two, false).film);
  EXPECT_FALSE(*render(checkered_floor(), one, true).film == *render(checkered_floor(), one, false).film);
  const RenderPlan path = settings(&kPath, 1);
  EXPECT_TRUE(*render(checkered_floor(), path, true).film == *render(checkered_floor(), path, false).film);
  RenderPlan part = one; // of a render of four samples
  part.sample_total = 4;
  EXPECT_TRUE(*render(checkered_floor(), part, true).film == *render(checkered_floor(), part, false).film);
}

TEST_F(MipFrames, GenericKernelsGiveTheSameBits) {
  RenderPlan one = settings(&kHybrid, 1);
  const RenderResult specialized = render(checkered_floor(), one, true);
  one.specialize = false;
  EXPECT_TRUE(*render(checkered_floor(), one, true).film == *specialized.film);
}

TEST(MipUse, IsThatOfFramesOfOneSample) {
  RenderPlan settings;
  settings.last_sample = 1;
  EXPECT_FALSE(uses_mips(settings)) << "path tracing";
  settings.integrator = &kHybrid;
  EXPECT_TRUE(uses_mips(settings));
  settings.last_sample = 64;
  EXPECT_FALSE(wants_mips(settings));
  settings.kernels.mips = true;
  EXPECT_TRUE(wants_mips(settings) && !uses_mips(settings));
  settings.antialias_over_time = true;
  EXPECT_TRUE(uses_mips(settings)) << "a window whose camera moves";
  settings.mips = false;
  EXPECT_FALSE(wants_mips(settings));
}

TEST(MipUse, CostsNothingWhereNobodyAsks) {
  Scene scene = checkered_floor();
  const PackedScene with = pack(scene, {.mips = true}), without = pack(scene);
  EXPECT_EQ(without.texels.size(), 64u);
  EXPECT_EQ(without.textures[0].mip_count, 0u);
  EXPECT_EQ(without.features & gpu::kFeatureMips, 0u);
  EXPECT_EQ(with.features, without.features | gpu::kFeatureMips);
  const auto left_out = std::ranges::find(without.left_out, "mip levels of textures", &LeftOut::what);
  ASSERT_NE(left_out, without.left_out.end());
  EXPECT_EQ(left_out->bytes, 4 * (with.texels.size() - without.texels.size()));
  EXPECT_EQ(std::ranges::find(with.left_out, "mip levels of textures", &LeftOut::what), with.left_out.end());
  EXPECT_EQ(plan(scene).texel_bytes, 4 * without.texels.size());
  EXPECT_EQ(plan(scene, {.mips = true}).texel_bytes, 4 * with.texels.size());
}

} // namespace
} // namespace wavepath::test
