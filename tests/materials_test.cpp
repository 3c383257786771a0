// Materials, textures, texels and the feature bits that follow from them.
#include "host/scene/pack/materials.h"

#include <bit>
#include <cmath>

#include <gtest/gtest.h>

#include "host/scene/pack/pack.h"
#include "kernels/base/features.h"
#include "kernels/base/scene_types.h"
#include "kernels/base/tile_order.h"
#include "tests/scene_builder.h"

namespace wavepath {
namespace {

Image byte_image(std::uint32_t width, std::uint32_t height, const std::vector<std::uint8_t>& bytes) {
  return {"bytes", width, height, bytes, {}};
}

gpu::Feature features_of(const Material& material) {
  Scene scene = triangle_scene();
  scene.images.push_back(byte_image(1, 1, {10, 20, 30, 255}));
  scene.materials[0] = material;
  return pack(scene).features;
}

// Of a triangle that shows a white texel and another one.
std::uint32_t flags_of(const Material& material, const std::vector<std::uint8_t>& texel = {255, 255, 255, 255},
                       float color_alpha = 1.0f) {
  Scene scene = triangle_scene();
  std::vector<std::uint8_t> bytes(4, 255);
  bytes.insert(bytes.end(), texel.begin(), texel.end());
  scene.images.push_back(byte_image(2, 1, bytes));
  scene.meshes[0].uvs[0] = {{0.0f, 0.0f}, {1.0f, 0.0f}, {0.0f, 1.0f}};
  scene.materials[0] = material;
  scene.materials[0].base_color_texture.image = 0;
  scene.meshes[0].colors.assign(3, glm::vec4(1.0f));
  scene.meshes[0].colors[1].a = color_alpha;
  return pack(scene).triangles[0].surface & ~gpu::kTriangleMaterialMask;
}

TEST(Materials, KeepOnlyThoseInUse) {
  Scene scene = triangle_scene();
  scene.materials.assign(4, plain_material());
  for (int i = 0; i < 4; ++i) scene.materials[static_cast<std::size_t>(i)].roughness = 0.1f * static_cast<float>(i);
  scene.images.assign(3, byte_image(1, 1, {1, 2, 3, 4}));
  for (std::uint32_t i = 0; i < 3; ++i) scene.materials[i].base_color_texture.image = i;
  scene.meshes[0].primitives[0].material = 2;
  add_instance(scene, add_mesh(scene, kUnitTriangle, 3));
  add_mesh(scene, kUnitTriangle, 1); // not shown
  const PackedScene packed = pack(scene);
  ASSERT_EQ(packed.materials.size(), 2u);
  EXPECT_EQ(packed.materials[0].roughness, 0.2f);
  EXPECT_EQ(packed.materials[1].roughness, 0.3f);
  EXPECT_EQ(packed.textures.size(), 1u);
  EXPECT_EQ(packed.texels.size(), 16u); // one tile
}

TEST(Materials, CarryEveryField) {
  Scene scene = triangle_scene();
  Material& m = scene.materials[0];
  m.base_color = {0.1f, 0.2f, 0.3f, 0.4f};
  m.metallic = 0.5f;
  m.roughness = 0.6f;
  m.emission = {7.0f, 8.0f, 9.0f};
  m.normal_scale = 1.1f;
  m.alpha_cutoff = 0.12f;
  m.ior = 1.3f;
  m.specular = 0.14f;
  m.specular_color = {0.15f, 0.16f, 0.17f};
  m.transmission = 0.18f;
  m.attenuation = {0.19f, 0.2f, 0.21f};
  m.volume = true;
  m.alpha_mode = AlphaMode::blend;
  const gpu::Material g = pack(scene).materials[0];
  EXPECT_EQ(g.base_color, m.base_color);
  EXPECT_EQ(g.emission, m.emission);
  EXPECT_EQ(g.specular_color, m.specular_color);
  EXPECT_EQ(g.attenuation, m.attenuation);
  EXPECT_EQ(g.metallic, 0.5f);
  EXPECT_EQ(g.roughness, 0.6f);
  EXPECT_EQ(g.normal_scale, 1.1f);
  EXPECT_EQ(g.alpha_cutoff, 0.12f);
  EXPECT_EQ(g.ior, 1.3f);
  EXPECT_EQ(g.specular, 0.14f);
  EXPECT_EQ(g.transmission, 0.18f);
  EXPECT_EQ(g.flags,
            gpu::kMaterialDoubleSided | gpu::kMaterialBlend | gpu::kMaterialVolume | 1u << gpu::kMaterialPriorityShift);
  for (const std::uint32_t texture :
       {g.base_color_texture, g.metallic_roughness_texture, g.normal_texture, g.emission_texture, g.specular_texture,
        g.specular_color_texture, g.transmission_texture})
    EXPECT_EQ(texture, gpu::kNone);
}

TEST(Materials, LayersStandBehindTheMaterialsThatHaveThem) {
  Scene scene = triangle_scene();
  EXPECT_TRUE(pack(scene).layers.empty());
  EXPECT_TRUE(pack(scene).albedo_tables.empty());
  scene.materials[0].coat = 0.5f;
  PackedScene packed = pack(scene);
  ASSERT_EQ(packed.layers.size(), packed.materials.size());
  EXPECT_EQ(packed.layers[0].coat, 0.5f);
  EXPECT_EQ(packed.layers[0].coat_texture, gpu::kNone);
  EXPECT_EQ(packed.features & gpu::kLobesAll, gpu::kLobeCoat);
  EXPECT_TRUE(packed.albedo_tables.empty());

  scene.materials[0].sheen_color = {0.1f, 0.2f, 0.3f};
  packed = pack(scene);
  EXPECT_EQ(packed.features & gpu::kLobesAll, gpu::kLobeCoat | gpu::kLobeSheen);
  EXPECT_EQ(packed.albedo_tables.size(), gpu::kTableTexels);
  EXPECT_EQ(packed.layers[0].sheen_table, gpu::kMaterialTexels + gpu::kLayerTexels);

  // Rough glass has its tables by ior, behind that of microfacets.
  scene.materials[0] = plain_material();
  scene.materials[0].transmission = 1.0f, scene.materials[0].volume = true, scene.materials[0].roughness = 0.5f;
  packed = pack(scene);
  EXPECT_EQ(packed.features & gpu::kLobesAll, gpu::kLobeMultiple);
  EXPECT_EQ(packed.albedo_tables.size(), 3 * gpu::kTableTexels);
  EXPECT_EQ(packed.layers[0].glass_table, packed.layers[0].ggx_table + gpu::kTableTexels);
}

TEST(Materials, PointEverySlotAtItsOwnTexture) {
  Scene scene = triangle_scene();
  Material& m = scene.materials[0];
  TextureSlot* slots[] = {&m.base_color_texture,  &m.metallic_roughness_texture, &m.normal_texture,
                          &m.emission_texture,    &m.specular_texture,           &m.specular_color_texture,
                          &m.transmission_texture};
  for (std::uint32_t i = 0; i < 7; ++i) {
    scene.images.push_back(byte_image(i + 1, 1, std::vector<std::uint8_t>(4 * (i + 1), static_cast<std::uint8_t>(i))));
    slots[i]->image = i;
  }
  const PackedScene packed = pack(scene);
  const gpu::Material& g = packed.materials[0];
  const std::uint32_t indices[] = {g.base_color_texture,  g.metallic_roughness_texture, g.normal_texture,
                                   g.emission_texture,    g.specular_texture,           g.specular_color_texture,
                                   g.transmission_texture};
  for (std::uint32_t i = 0; i < 7; ++i) {
    EXPECT_EQ(packed.textures[indices[i]].width, i + 1);
    EXPECT_EQ(packed.texels[packed.textures[indices[i]].first_texel], i * 0x01010101u);
  }
}

TEST(Textures, AreSharedWhereTheyAreTheSameUse) {
  Scene scene = triangle_scene();
  scene.images.push_back(byte_image(2, 1, {1, 2, 3, 4, 5, 6, 7, 8}));
  Material& m = scene.materials[0];
  m.base_color_texture.image = m.emission_texture.image = m.normal_texture.image = m.transmission_texture.image = 0;
  m.base_color_texture.srgb = m.emission_texture.srgb = true;
  m.transmission_texture.wrap_v = Wrap::mirror;
  m.transmission_texture.nearest = true;
  m.transmission_texture.uv_set = 1;
  const PackedScene packed = pack(scene);
  ASSERT_EQ(packed.texels.size(), 16u); // stored once
  EXPECT_EQ(packed.texels[0], 0x04030201u);
  EXPECT_EQ(packed.texels[1], 0x08070605u);
  ASSERT_EQ(packed.textures.size(), 3u);
  const gpu::Material& g = packed.materials[0];
  EXPECT_EQ(g.base_color_texture, g.emission_texture);
  EXPECT_EQ(packed.textures[g.base_color_texture].flags, gpu::kTextureSrgb);
  EXPECT_EQ(packed.textures[g.normal_texture].flags, 0u);
  EXPECT_EQ(packed.textures[g.transmission_texture].flags,
            gpu::kTextureNearest | gpu::kTextureUv1 | gpu::kWrapMirror << gpu::kTextureWrapVShift);
}

TEST(Textures, CarryTheirTransformByRows) {
  Scene scene = triangle_scene();
  scene.images.push_back(byte_image(1, 1, {0, 0, 0, 0}));
  TextureSlot& slot = scene.materials[0].base_color_texture;
  slot.image = 0;
  slot.uv_matrix = glm::mat2(1.0f, 2.0f, 3.0f, 4.0f); // columns (1,2) and (3,4)
  slot.uv_offset = {5.0f, 6.0f};
  const PackedScene packed = pack(scene);
  const gpu::Texture& t = packed.textures[0];
  const glm::vec2 uv{0.3f, 0.7f};
  const glm::vec2 expected = slot.uv_matrix * uv + slot.uv_offset;
  EXPECT_FLOAT_EQ(t.uv_matrix.x * uv.x + t.uv_matrix.y * uv.y + t.uv_offset.x, expected.x);
  EXPECT_FLOAT_EQ(t.uv_matrix.z * uv.x + t.uv_matrix.w * uv.y + t.uv_offset.y, expected.y);
  EXPECT_NE(packed.features & gpu::kFeatureTextureTransform, 0u);
}

TEST(Textures, StoreFloatImagesLinear) {
  Scene scene = triangle_scene();
  scene.images.push_back({"floats", 1, 1, {}, {0.5f, 0.04f, 1.0f, 0.5f}});
  Material& m = scene.materials[0];
  m.base_color_texture.image = m.normal_texture.image = 0;
  m.base_color_texture.srgb = true;
  const PackedScene packed = pack(scene);
  ASSERT_EQ(packed.texels.size(), 2u * 64u); // decoded, and as it is
  const auto value = [&](std::uint32_t texture, std::uint32_t channel) {
    return std::bit_cast<float>(packed.texels[packed.textures[texture].first_texel + channel]);
  };
  const gpu::Material& g = packed.materials[0];
  EXPECT_FLOAT_EQ(value(g.base_color_texture, 0), 0.21404114f);
  EXPECT_FLOAT_EQ(value(g.base_color_texture, 1), 0.04f / 12.92f);
  EXPECT_FLOAT_EQ(value(g.base_color_texture, 2), 1.0f);
  EXPECT_EQ(value(g.base_color_texture, 3), 0.5f); // alpha is linear
  EXPECT_EQ(value(g.normal_texture, 0), 0.5f);
  for (const gpu::Texture& t : packed.textures) EXPECT_EQ(t.flags, gpu::kTextureFloat);
}

TEST(Textures, ReadBackAsTheKernelsSeeThem) {
  Scene scene = triangle_scene();
  scene.images.push_back(byte_image(2, 2, {0, 0, 0, 0, 255, 128, 64, 32, 1, 2, 3, 4, 5, 6, 7, 8}));
  scene.materials[0].base_color_texture.image = 0;
  scene.materials[0].base_color_texture.srgb = true;
  const PackedScene packed = pack(scene);
  const glm::vec4 texel = read_texel(packed.textures[0], packed.texels, 1, 0);
  EXPECT_FLOAT_EQ(texel.r, 1.0f);
  EXPECT_FLOAT_EQ(texel.g, 0.21586050f);
  EXPECT_FLOAT_EQ(texel.b, 0.051269457f);
  EXPECT_FLOAT_EQ(texel.a, 32.0f / 255.0f);
}

TEST(TriangleFlags, KnowWhereAlphaCanMatter) {
  Material m = plain_material();
  m.alpha_mode = AlphaMode::blend;
  m.base_color.a = 1.0f;
  EXPECT_EQ(flags_of(m), 0u); // nothing can let a ray through
  EXPECT_EQ(flags_of(m, {255, 255, 255, 254}), gpu::kTriangleAlpha);
  EXPECT_EQ(flags_of(m, {255, 255, 255, 255}, 0.5f), gpu::kTriangleAlpha);
  m.base_color.a = 0.99f;
  EXPECT_EQ(flags_of(m), gpu::kTriangleAlpha);
  m.alpha_mode = AlphaMode::mask;
  m.alpha_cutoff = 0.5f;
  EXPECT_EQ(flags_of(m), 0u);
  EXPECT_EQ(flags_of(m, {255, 255, 255, 130}), 0u);
  EXPECT_EQ(flags_of(m, {255, 255, 255, 127}), gpu::kTriangleAlpha);
  EXPECT_EQ(flags_of(m, {255, 255, 255, 130}, 0.9f), gpu::kTriangleAlpha);
  m.alpha_mode = AlphaMode::opaque;
  EXPECT_EQ(flags_of(m, {0, 0, 0, 0}, 0.0f), 0u); // alpha is ignored
  m.unlit = true;
  EXPECT_EQ(flags_of(m), gpu::kTriangleAlpha); // rays pass, except the eye's
}

TEST(TriangleFlags, CullOnlySingleSidedOpaqueSurfaces) {
  Material m = plain_material();
  EXPECT_EQ(flags_of(m), 0u);
  m.double_sided = false;
  EXPECT_EQ(flags_of(m), gpu::kTriangleSingleSided);
  m.transmission = 0.5f;
  EXPECT_EQ(flags_of(m), 0u);
}

TEST(TriangleFlags, FindThinSmoothGlass) {
  Material pane = plain_material();
  pane.transmission = 0.1f, pane.metallic = 0.9f, pane.roughness = 0.009f;
  EXPECT_EQ(flags_of(pane), gpu::kTrianglePane);
  Material m = pane;
  m.roughness = 0.011f;
  EXPECT_EQ(flags_of(m), 0u);
  m = pane;
  m.volume = true;
  EXPECT_EQ(flags_of(m), 0u);
  m.ior = 1.0f, m.roughness = 0.5f; // the wall of a body that bends nothing
  EXPECT_EQ(flags_of(m), gpu::kTrianglePane);
  m = pane;
  m.metallic = 1.0f;
  EXPECT_EQ(flags_of(m), 0u);
  m = pane;
  m.unlit = true;
  EXPECT_EQ(flags_of(m), gpu::kTriangleAlpha);
}

TEST(Features, FollowTheMaterialsInUse) {
  const Material plain = plain_material();
  EXPECT_EQ(features_of(plain), 0u);
  Material m = plain;
  m.double_sided = false;
  EXPECT_EQ(features_of(m), gpu::kFeatureCull);
  m = plain;
  m.metallic = 0.1f;
  EXPECT_EQ(features_of(m), gpu::kFeatureSpecular | gpu::kLobeMultiple);
  m.roughness = 0.0f; // a mirror has no second bounce
  EXPECT_EQ(features_of(m), gpu::kFeatureSpecular);
  m = plain;
  m.specular = 1.0f;
  EXPECT_EQ(features_of(m), gpu::kFeatureSpecular);
  m = plain;
  m.unlit = true;
  m.specular = m.transmission = 1.0f;
  EXPECT_EQ(features_of(m), gpu::kFeatureEmission | gpu::kFeatureAlpha); // seen by the eye alone; nothing else counts
  m = plain;
  m.transmission = 1.0f;
  m.volume = true;
  EXPECT_EQ(features_of(m) & gpu::kLobesAll, gpu::kLobeMultiple);
  m.roughness = 0.0f;
  EXPECT_EQ(features_of(m), gpu::kFeatureSpecular | gpu::kFeatureTransmission); // clear glass needs no medium
  m.attenuation = {0.0f, 1.0f, 0.0f};
  EXPECT_EQ(features_of(m), gpu::kFeatureSpecular | gpu::kFeatureTransmission | gpu::kFeatureVolume);
  m = plain;
  m.normal_texture.image = 0;
  EXPECT_EQ(features_of(m), gpu::kFeatureTextures | gpu::kFeatureNormalMaps);
  const std::pair<TextureSlot Material::*, gpu::Feature> slots[] = {
      {&Material::base_color_texture, gpu::kFeatureBaseColorTextures},
      {&Material::metallic_roughness_texture, gpu::kFeatureMetallicRoughnessTextures},
      {&Material::specular_texture, gpu::kFeatureSpecularTextures},
      {&Material::specular_color_texture, gpu::kFeatureSpecularTextures},
      {&Material::transmission_texture, gpu::kFeatureTransmissionTextures},
      {&Material::emission_texture, gpu::kFeatureEmissionTextures}};
  for (const auto& [slot, feature] : slots) {
    m = plain;
    (m.*slot).image = 0;
    EXPECT_EQ(features_of(m), gpu::kFeatureTextures | feature);
    (m.*slot).nearest = true;
    EXPECT_EQ(features_of(m), gpu::kFeatureTextures | feature | gpu::kFeatureNearestTextures);
  }
}

// Every texel of an image of any size is found again, and each has a place of its own.
TEST(Texels, LieInTiles) {
  for (const glm::uvec2 size : {glm::uvec2(1, 1), {4, 4}, {5, 3}, {17, 9}})
    for (const std::uint32_t beside : {0u, 1u, 2u}) {
      std::vector<int> seen(gpu::texel_count(size.x, size.y, beside), 0);
      const std::uint32_t columns = beside == 2 ? 2 : 4, rows = beside == 0 ? 4 : 2;
      const auto place = [&](std::uint32_t x, std::uint32_t y) { return gpu::texel_index(x, y, size.x, beside); };
      for (std::uint32_t y = 0; y < size.y; ++y)
        for (std::uint32_t x = 0; x < size.x; ++x) {
          EXPECT_EQ(place(x, y) / 16, place(x / columns * columns, y / rows * rows) / 16);
          for (std::uint32_t image = 0; image < 1u << beside; ++image) {
            const std::uint32_t at = place(x, y) + image * (16u >> beside);
            ASSERT_LT(at, seen.size());
            EXPECT_EQ(++seen[at], 1);
            EXPECT_EQ(at / 16, place(x, y) / 16);
          }
        }
    }
}

// What a material looks up together lies in the same lines of the cache, and every texel is what the file has.
TEST(Texels, OfOneMaterialLieSideBySide) {
  Scene scene = triangle_scene();
  const auto add_image = [&](std::uint32_t width, std::uint32_t height, std::uint8_t key) {
    Image image{.width = width, .height = height};
    for (std::uint32_t i = 0; i < 4 * width * height; ++i)
      image.bytes.push_back(static_cast<std::uint8_t>(key + 7 * i));
    scene.images.push_back(image);
    return static_cast<std::uint32_t>(scene.images.size() - 1);
  };
  Material& m = scene.materials[0];
  m.base_color_texture.image = add_image(7, 5, 1);
  m.metallic_roughness_texture.image = add_image(7, 5, 2);
  m.normal_texture.image = add_image(7, 5, 3);
  m.emission_texture.image = add_image(3, 5, 4); // of another size: alone
  m.emission = glm::vec3(1.0f);
  const auto texture_at = [](const PackedScene& packed, std::uint32_t gpu::Material::*slot) {
    return packed.textures[packed.materials[0].*slot];
  };
  const auto beside = [](const gpu::Texture& t) { return t.flags >> gpu::kTextureBesideShift & 3u; };
  const auto expect_texels = [&](const PackedScene& packed, std::uint32_t gpu::Material::*slot, std::uint32_t image) {
    const gpu::Texture texture = texture_at(packed, slot);
    for (std::uint32_t y = 0; y < texture.height; ++y)
      for (std::uint32_t x = 0; x < texture.width; ++x) {
        const std::uint32_t word =
            packed.texels[texture.first_texel + gpu::texel_index(x, y, texture.width, beside(texture))];
        EXPECT_EQ(word & 255u, scene.images[image].bytes[4 * (y * texture.width + x)]);
      }
  };
  const PackedScene packed = pack(scene);
  expect_texels(packed, &gpu::Material::base_color_texture, 0);
  expect_texels(packed, &gpu::Material::metallic_roughness_texture, 1);
  expect_texels(packed, &gpu::Material::normal_texture, 2);
  expect_texels(packed, &gpu::Material::emission_texture, 3);
  const gpu::Texture base = texture_at(packed, &gpu::Material::base_color_texture);
  EXPECT_EQ(beside(base), 2u);
  EXPECT_EQ(texture_at(packed, &gpu::Material::metallic_roughness_texture).first_texel, base.first_texel + 4);
  EXPECT_EQ(texture_at(packed, &gpu::Material::normal_texture).first_texel, base.first_texel + 8);
  EXPECT_EQ(beside(texture_at(packed, &gpu::Material::emission_texture)), 0u);

  m.alpha_mode = AlphaMode::mask; // traversal looks the base colour up alone
  const PackedScene masked = pack(scene);
  expect_texels(masked, &gpu::Material::base_color_texture, 0);
  expect_texels(masked, &gpu::Material::normal_texture, 2);
  EXPECT_EQ(beside(texture_at(masked, &gpu::Material::base_color_texture)), 0u);
  EXPECT_EQ(beside(texture_at(masked, &gpu::Material::normal_texture)), 1u);

  m.alpha_mode = AlphaMode::opaque;
  m.normal_texture.uv_set = 1; // looked up elsewhere
  EXPECT_EQ(beside(texture_at(pack(scene), &gpu::Material::normal_texture)), 0u);
}

TEST(Features, ListWhatIsLeftOutWithReasons) {
  Scene scene = triangle_scene();
  const PackedScene bare = pack(scene);
  const auto find = [](const PackedScene& packed, const std::string& what) {
    for (const LeftOut& entry : packed.left_out)
      if (entry.what == what) return entry;
    return LeftOut{};
  };
  for (const LeftOut& entry : bare.left_out) EXPECT_FALSE(entry.why.empty()) << entry.what;
  EXPECT_EQ(find(bare, "vertex colours").bytes, 3u * 16u);
  EXPECT_EQ(find(bare, "vertex indices").bytes, 16u);
  EXPECT_FALSE(find(bare, "two-level BVH").why.empty());
  EXPECT_FALSE(find(bare, "transmission").why.empty());
  scene.meshes[0].colors.assign(3, glm::vec4(1.0f));
  scene.materials[0].transmission = 1.0f;
  const PackedScene more = pack(scene);
  for (const char* what : {"vertex colours", "vertex indices", "transmission"})
    EXPECT_TRUE(find(more, what).why.empty()) << what;
}

} // namespace
} // namespace wavepath
