// Atlases of textures: places, borders, mip levels, and what does not fit.
#include "host/scene/pack/atlas.h"

#include <cstring>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "host/scene/pack/pack.h"
#include "host/scene/pack/plan.h"
#include "host/scene/pack/textures.h"
#include "kernels/base/scene_types.h"
#include "kernels/base/tile_order.h"
#include "tests/scene_builder.h"

namespace wavepath::test {
namespace {

constexpr SamplerLimits kRoomy{16384, 2048, std::uint64_t{1} << 31};

std::vector<AtlasTile> square_tiles(std::initializer_list<std::pair<std::uint32_t, std::uint32_t>> counts_and_sides) {
  std::vector<AtlasTile> tiles;
  for (const auto& [count, side] : counts_and_sides)
    for (std::uint32_t i = 0; i < count; ++i) tiles.push_back({.width = side + 2, .height = side + 2});
  return tiles;
}

std::uint64_t texels_of(const std::vector<AtlasTile>& tiles) {
  return std::accumulate(tiles.begin(), tiles.end(), std::uint64_t{0}, [](std::uint64_t sum, const AtlasTile& tile) {
    return sum + std::uint64_t{tile.width} * tile.height;
  });
}

std::size_t count_placed(const std::vector<AtlasTile>& tiles) {
  return static_cast<std::size_t>(std::ranges::count_if(tiles, &AtlasTile::is_placed));
}

// Every tile that has a place lies within the atlas, on texels of its own.
void expect_sound(const std::vector<AtlasTile>& tiles, const Atlas& atlas, const SamplerLimits& limits) {
  EXPECT_LE(std::max(atlas.width, atlas.height), limits.side);
  EXPECT_LE(atlas.layers, limits.layers);
  EXPECT_LE(atlas.bytes(), limits.bytes);
  EXPECT_TRUE(atlas.empty() || (atlas.width % 2 == 1 && atlas.height % 2 == 1)) << "no power of two";
  std::vector<bool> taken(atlas.bytes() / 4);
  for (const AtlasTile& tile : tiles) {
    if (!tile.is_placed()) continue;
    ASSERT_LE(tile.x + tile.width, atlas.width);
    ASSERT_LE(tile.y + tile.height, atlas.height);
    ASSERT_LT(tile.layer, atlas.layers);
    for (std::uint32_t y = tile.y; y < tile.y + tile.height; ++y)
      for (std::uint32_t x = tile.x; x < tile.x + tile.width; ++x) {
        const std::size_t texel = (std::size_t{tile.layer} * atlas.height + y) * atlas.width + x;
        ASSERT_FALSE(taken[texel]);
        taken[texel] = true;
      }
  }
}

TEST(Atlas, TilesLieApart) {
  std::mt19937 random(5);
  std::uniform_int_distribution<std::uint32_t> side(3, 122);
  for (const SamplerLimits& limits :
       {kRoomy, SamplerLimits{256, 64, 1u << 24}, SamplerLimits{255, 3, 1u << 24}, SamplerLimits{256, 64, 300'000}}) {
    std::vector<AtlasTile> tiles;
    for (int i = 0; i < 200; ++i) tiles.push_back({.width = side(random), .height = side(random)});
    const Atlas atlas = place_tiles(tiles, limits);
    expect_sound(tiles, atlas, limits);
    EXPECT_GT(count_placed(tiles), 10u);
    EXPECT_EQ(count_placed(tiles) == tiles.size(), limits.layers > 3 && limits.bytes > 300'000);
  }
}

TEST(Atlas, LittleIsWasted) {
  const auto waste = [](std::vector<AtlasTile> tiles) {
    const Atlas atlas = place_tiles(tiles, kRoomy);
    EXPECT_EQ(count_placed(tiles), tiles.size());
    return static_cast<double>(atlas.bytes() / 4) / static_cast<double>(texels_of(tiles));
  };
  EXPECT_LT(waste(square_tiles({{1, 2048}})), 1.01);
  EXPECT_LT(waste(square_tiles({{69, 1024}})), 1.01);
  EXPECT_LT(waste(square_tiles({{3, 2048}, {16, 512}})), 1.02) << "small ones beside each other, borders and all";
  EXPECT_LT(waste(square_tiles({{1, 4096}, {1, 16}})), 1.02) << "no layer for a stamp";
  EXPECT_LT(waste(square_tiles({{5, 2048}, {7, 1024}, {9, 512}, {20, 64}})), 1.15);
}

TEST(Atlas, WhatDoesNotFitHasNoPlace) {
  std::vector<AtlasTile> tiles = square_tiles({{3, 64}, {1, 10}});
  EXPECT_FALSE(fits_layer(tiles[0], {65, 1, 1u << 20}));
  EXPECT_FALSE(fits_layer(tiles[0], {66, 1, 1u << 20})) << "sides are odd";
  EXPECT_TRUE(fits_layer(tiles[0], {67, 1, 1u << 20}));
  EXPECT_FALSE(fits_layer(tiles[0], {67, 1, 67 * 67 * 4 - 1}));
  EXPECT_FALSE(fits_layer(tiles[0], {67, 0, 1u << 20}));
  const Atlas atlas = place_tiles(tiles, {100, 2, 1u << 20});
  EXPECT_EQ(count_placed(tiles), 3u);
  EXPECT_EQ(atlas.layers, 2u);
  EXPECT_TRUE(place_tiles(tiles, {100, 0, 1u << 20}).empty());
  std::vector<AtlasTile> none;
  EXPECT_TRUE(place_tiles(none, kRoomy).empty());
}

// A material with an image of a width and a height of its own, texel (x, y) of which is (x, y, 7, alpha).
void add_image(Scene& scene, std::uint32_t width, std::uint32_t height) {
  Image& image = scene.images.emplace_back();
  image.width = width, image.height = height;
  for (std::uint32_t i = 0; i < width * height; ++i)
    for (const std::uint32_t byte : {i % width, i / width, 7u, 255 - i % 200})
      image.bytes.push_back(static_cast<std::uint8_t>(byte));
}

TEST(Atlas, BordersHoldWhatFiltersMeet) {
  Scene scene;
  add_image(scene, 3, 2);
  std::vector<AtlasTile> tiles{make_tile(scene, 0, {}, false, true, false), // repeats along u, not along v
                               make_tile(scene, 0, {}, false, false, true)};
  Atlas atlas = place_tiles(tiles, kRoomy);
  fill_atlas(scene, tiles, atlas);
  const auto texel = [&](std::size_t tile, std::uint32_t x, std::uint32_t y) {
    const std::size_t row = std::size_t{tiles[tile].layer} * atlas.height + tiles[tile].y + y;
    const std::uint32_t word = atlas.words[row * atlas.width + tiles[tile].x + x];
    return std::pair(word & 255u, word >> 8 & 255u);
  };
  for (std::uint32_t y = 0; y < 4; ++y)
    for (std::uint32_t x = 0; x < 5; ++x) {
      EXPECT_EQ(texel(0, x, y), std::pair((x + 2) % 3, y < 2 ? 0u : 1u));
      EXPECT_EQ(texel(1, x, y), std::pair(x == 0 ? 0u : std::min(x - 1, 2u), (y + 1) % 2));
    }
}

// A triangle for each of several images in several uses.
Scene textured_scene() {
  Scene scene;
  scene.path = "test";
  const std::pair<std::uint32_t, std::uint32_t> sizes[] = {{5, 9}, {64, 16}, {1, 1}, {33, 2}};
  for (std::uint32_t i = 0; i < 4; ++i) {
    add_image(scene, sizes[i].first, sizes[i].second);
    Material& material = scene.materials.emplace_back(plain_material());
    material.alpha_mode = i % 2 ? AlphaMode::mask : AlphaMode::opaque;
    material.base_color_texture = {.image = i, .wrap_u = Wrap::clamp, .srgb = true};
    material.metallic_roughness_texture = {.image = i, .wrap_v = Wrap::mirror};
    add_instance(scene, add_mesh(scene, kUnitTriangle, i));
    scene.meshes.back().uvs[0].assign(3, glm::vec2(0.0f));
  }
  return scene;
}

PackedScene pack_sampled(Scene& scene, bool mips, const SamplerLimits& limits = kRoomy) {
  return pack(scene, {.mips = mips, .samplers = limits});
}

TEST(SampledTextures, HoldTheSameTexels) {
  for (const bool mips : {false, true}) {
    Scene scene = textured_scene();
    const PackedScene exact = pack(scene, {.mips = mips}), sampled = pack_sampled(scene, mips);
    ASSERT_EQ(exact.textures.size(), 8u);
    ASSERT_EQ(sampled.textures.size(), 8u);
    EXPECT_TRUE(sampled.texels.empty()) << "nothing reads it";
    EXPECT_EQ(sampled.features & (gpu::kFeatureSampledTextures | gpu::kFeatureExactTextures),
              gpu::kFeatureSampledTextures);
    EXPECT_EQ(exact.features & (gpu::kFeatureSampledTextures | gpu::kFeatureExactTextures), 0u);
    for (std::size_t i = 0; i < 8; ++i) {
      gpu::Texture from = exact.textures[i], to = sampled.textures[i];
      EXPECT_TRUE(to.flags & gpu::kTextureSampled);
      ASSERT_EQ(from.mip_count, to.mip_count);
      for (std::uint32_t level = 0; level <= from.mip_count; ++level) {
        for (std::uint32_t y = 0; y < from.height; ++y)
          for (std::uint32_t x = 0; x < from.width; ++x)
            ASSERT_EQ(read_texel(from, exact.texels, x, y), read_texel(to, sampled.texels, sampled.atlases, x, y));
        if (level == from.mip_count) break;
        // As kernels/surface/texture.glsl finds the next level.
        if (level == 0)
          to.first_texel += to.width + 2, from.first_texel = from.first_mip;
        else
          to.first_texel += (to.height + 2) << 16, from.first_texel += gpu::texel_count(from.width, from.height, 0);
        from.width = to.width = gpu::mip_size(exact.textures[i].width, level + 1);
        from.height = to.height = gpu::mip_size(exact.textures[i].height, level + 1);
      }
    }
  }
}

TEST(SampledTextures, ArePlanned) {
  for (const bool mips : {false, true}) {
    Scene scene = textured_scene();
    const PackedScene packed = pack_sampled(scene, mips);
    const ScenePlan planned = plan(scene, {.mips = mips, .samplers = kRoomy});
    EXPECT_EQ(planned.texel_bytes, packed.atlases[0].bytes() + packed.atlases[1].bytes());
    EXPECT_EQ(packed.atlases[1].words.size() * 4, packed.atlases[1].bytes());
    EXPECT_GT(planned.texel_bytes, 0u);
  }
}

TEST(SampledTextures, WhatSamplersCannotDoStaysExact) {
  const auto told = [](const Scene& scene, std::string_view what) {
    std::size_t count = 0;
    for (const auto& [text, times] : scene.warnings.counts())
      if (text.find("in spite of --textures hardware") != std::string::npos && text.find(what) != std::string::npos)
        count += times;
    return count;
  };
  Scene scene = textured_scene();
  const std::size_t texels = scene.images[0].width * scene.images[0].height;
  scene.images[0].bytes.clear();
  scene.images[0].floats.assign(4 * texels, 0.5f);
  scene.materials[3].base_color_texture.srgb = false; // kernels ask for a colour
  const PackedScene mixed = pack_sampled(scene, false);
  EXPECT_EQ(told(scene, "more than 8 bits"), 2u);
  EXPECT_EQ(told(scene, "cannot hold"), 1u);
  EXPECT_TRUE(mixed.features & gpu::kFeatureExactTextures);
  EXPECT_EQ(std::ranges::count_if(mixed.textures, [](const gpu::Texture& t) { return t.flags & gpu::kTextureSampled; }),
            5);
  EXPECT_EQ(plan(scene, {.samplers = kRoomy}).texel_bytes,
            4 * mixed.texels.size() + mixed.atlases[0].bytes() + mixed.atlases[1].bytes());

  // A device whose images are too small, and one that has too few layers.
  for (const SamplerLimits& limits : {SamplerLimits{32, 8, 1u << 20}, SamplerLimits{70, 1, 70 * 20 * 4}}) {
    Scene large = textured_scene();
    const PackedScene packed = pack_sampled(large, true, limits);
    const std::size_t exact = told(large, "cannot hold");
    EXPECT_GT(exact, 0u);
    EXPECT_LT(exact, 8u);
    EXPECT_EQ(exact, static_cast<std::size_t>(std::ranges::count_if(
                         packed.textures, [](const gpu::Texture& t) { return !(t.flags & gpu::kTextureSampled); })));
    const PackedScene reference = pack(large, {.mips = true});
    for (std::size_t i = 0; i < 8; ++i)
      EXPECT_EQ(read_texel(packed.textures[i], packed.texels, packed.atlases, 0, 0),
                read_texel(reference.textures[i], reference.texels, 0, 0));
  }
  Scene none = textured_scene();
  const PackedScene packed = pack_sampled(none, false, {2, 8, 1u << 20}), exact = pack(none);
  EXPECT_EQ(packed.features, exact.features) << "as without the flag";
  EXPECT_EQ(packed.texels, exact.texels);
}

} // namespace
} // namespace wavepath::test
