// glTF import, feature by feature: materials, their extensions, textures and images.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/base/overloaded.h"
#include "host/codecs/jpeg.h"
#include "host/codecs/png.h"
#include "tests/gltf_checks.h"
#include "tests/ktx_builder.h"

namespace wavepath {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using test::load;
using test::TempFolder;
using test::warning_count;

// Two texels, red and half-blue with alpha 51, as a palette PNG.
const char kPalettePng[] =
    "\x89\x50\x4e\x47\x0d\x0a\x1a\x0a\x00\x00\x00\x0d\x49\x48\x44\x52\x00\x00\x00\x02\x00\x00\x00\x01"
    "\x08\x03\x00\x00\x00\xc3\xfc\x8f\xb8\x00\x00\x00\x06\x50\x4c\x54\x45\xff\x00\x00\x00\x80\xff\x57"
    "\x22\x65\xc5\x00\x00\x00\x02\x74\x52\x4e\x53\xff\x33\x5a\x67\x51\x5c\x00\x00\x00\x0b\x49\x44\x41"
    "\x54\x78\xda\x63\x60\x60\x04\x00\x00\x04\x00\x02\x2c\xde\x48\xad\x00\x00\x00\x00\x49\x45\x4e\x44"
    "\xae\x42\x60\x82";

// Two texels, (102, 51, 204) with alpha 128 and red, as a lossless WebP.
const char kWebp[] =
    "\x52\x49\x46\x46\x20\x00\x00\x00\x57\x45\x42\x50\x56\x50\x38\x4c\x14\x00\x00\x00\x2f\x01\x00\x00"
    "\x10\x0f\x30\x33\x3f\xfb\x1f\xe6\x07\xfe\x87\x16\x32\xa2\xff\x01";

// The triangle, with texture coordinates and this material.
GltfBuilder with_material(const json& material) {
  GltfBuilder b = GltfBuilder::triangle();
  b.primitive()["attributes"]["TEXCOORD_0"] = b.floats("VEC2", {0, 0, 1, 0, 0, 1});
  b.primitive()["attributes"]["TEXCOORD_1"] = b.floats("VEC2", {0, 0, 2, 0, 0, 2});
  b.primitive()["material"] = b.add("materials", material);
  return b;
}

GltfBuilder with_texture(const json& material) {
  GltfBuilder b = with_material(material);
  b.add("images", {{"name", "palette"}, {"bufferView", b.view(std::string(kPalettePng, sizeof(kPalettePng) - 1))}});
  b.add("textures", {{"source", 0}});
  return b;
}

Material only_material(const json& material) { return load(with_material(material)).materials.at(0); }

TEST(GltfMaterial, DefaultsAreThoseOfTheSpecification) {
  for (const Material& m : {load(GltfBuilder::triangle()).materials.at(0), only_material(json::object())}) {
    EXPECT_EQ(m.base_color, glm::vec4(1));
    EXPECT_EQ(m.metallic, 1.0f);
    EXPECT_EQ(m.roughness, 1.0f);
    EXPECT_EQ(m.emission, glm::vec3(0));
    EXPECT_EQ(m.alpha_mode, AlphaMode::opaque);
    EXPECT_EQ(m.alpha_cutoff, 0.5f);
    EXPECT_EQ(m.ior, 1.5f);
    EXPECT_EQ(m.specular, 1.0f);
    EXPECT_EQ(m.specular_color, glm::vec3(1));
    EXPECT_EQ(m.transmission, 0.0f);
    EXPECT_FALSE(m.double_sided || m.unlit || m.volume || m.base_color_texture.present());
  }
}

TEST(GltfMaterial, FactorsAndExtensions) {
  const Material m =
      only_material({{"name", "all"},
                     {"pbrMetallicRoughness",
                      {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.25}}},
                     {"emissiveFactor", {1, 0.5, 0}},
                     {"alphaMode", "MASK"},
                     {"alphaCutoff", 0.75},
                     {"doubleSided", true},
                     {"extensions",
                      {{"KHR_materials_emissive_strength", {{"emissiveStrength", 100}}},
                       {"KHR_materials_ior", {{"ior", 1.25}}},
                       {"KHR_materials_specular", {{"specularFactor", 0.5}, {"specularColorFactor", {0.5, 2, 0}}}},
                       {"KHR_materials_transmission", {{"transmissionFactor", 0.75}}}}}});
  EXPECT_EQ(m.name, "all");
  EXPECT_EQ(m.base_color, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
  EXPECT_EQ(m.metallic, 0.5f);
  EXPECT_EQ(m.roughness, 0.25f);
  EXPECT_EQ(m.emission, glm::vec3(100, 50, 0));
  EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
  EXPECT_EQ(m.alpha_cutoff, 0.75f);
  EXPECT_TRUE(m.double_sided);
  EXPECT_EQ(m.ior, 1.25f);
  EXPECT_EQ(m.specular, 0.5f);
  EXPECT_EQ(m.specular_color, glm::vec3(0.5, 2, 0)); // may exceed 1
  EXPECT_EQ(m.transmission, 0.75f);
  EXPECT_FALSE(m.volume);
  EXPECT_EQ(only_material({{"extensions", {{"KHR_materials_ior", {{"ior", 0}}}}}}).ior, 0.0f);
  EXPECT_EQ(only_material({{"alphaMode", "BLEND"}}).alpha_mode, AlphaMode::blend);
}

// --- the table of a material's fields ---

// A material in which the property at `path` has this value, and that lacks nothing else.
json material_with(const std::string& path, const json& value) {
  std::string pointer = "/" + path;
  std::replace(pointer.begin(), pointer.end(), '.', '/');
  json material;
  material[json::json_pointer(pointer)] = value;
  constexpr std::string_view kScale = ".scale"; // of a texture, which must have an index
  if (path.ends_with("Texture.scale")) {
    const std::string texture = pointer.substr(0, pointer.size() - kScale.size());
    material[json::json_pointer(texture)]["index"] = 0;
  }
  return material;
}

void expect_refused(const json& material) { EXPECT_THROW(load(with_texture(material)), Error) << material; }

TEST(GltfMaterial, EveryFactorIsReadCheckedAndClamped) {
  int count = 0;
  const auto check = [&]<class T>(const MaterialFactor<T>& row) {
    if (!*row.gltf) return;
    ++count;
    const double inside = row.lo + (std::min(row.hi, 2.0) - row.lo) * 0.75;
    const auto values = [](double value) -> json {
      if constexpr (std::is_same_v<T, float>)
        return value;
      else
        return std::vector<double>(T::length(), value);
    };
    EXPECT_EQ(load(with_texture(material_with(row.gltf, values(inside)))).materials.at(0).*row.field,
              T(static_cast<float>(inside)))
        << row.name;
    if (row.hi < 1e30) {
      const Scene scene = load(with_texture(material_with(row.gltf, values(2.0 * row.hi))));
      EXPECT_EQ(scene.materials[0].*row.field, T(static_cast<float>(row.hi))) << row.name;
      EXPECT_EQ(warning_count(scene, "clamped"), 1u) << row.name;
    }
    expect_refused(material_with(row.gltf, "text"));
    if (!std::is_same_v<T, float>) expect_refused(material_with(row.gltf, {0.5, 0.5}));
  };
  visit_material_fields(Overloaded{[](const auto&) {}, [&]<class T>(const MaterialFactor<T>& row) { check(row); }});
  EXPECT_GE(count, 10);
}

TEST(GltfMaterial, EveryTextureIsReadAndChecked) {
  int count = 0;
  visit_material_fields(Overloaded{[](const auto&) {},
                                   [&](const MaterialTexture& row) {
                                     ++count;
                                     json material = material_with(row.gltf, {{"index", 0}, {"texCoord", 1}});
                                     material["emissiveFactor"] = {1, 1, 1};
                                     json& extensions = material["extensions"];
                                     extensions["KHR_materials_transmission"]["transmissionFactor"] = 1;
                                     extensions["KHR_materials_clearcoat"]["clearcoatFactor"] = 1;
                                     extensions["KHR_materials_sheen"]["sheenColorFactor"] = {1, 1, 1};
                                     extensions["KHR_materials_anisotropy"]["anisotropyStrength"] = 1;
                                     extensions["KHR_materials_iridescence"]["iridescenceFactor"] = 1;
                                     extensions["KHR_materials_diffuse_transmission"]["diffuseTransmissionFactor"] = 1;
                                     const Material read = load(with_texture(material)).materials.at(0);
                                     const TextureSlot& slot = read.*row.field;
                                     EXPECT_TRUE(slot.present()) << row.name;
                                     EXPECT_EQ(slot.srgb, row.srgb) << row.name;
                                     EXPECT_EQ(slot.uv_set, 1u) << row.name;
                                     int textures = 0;
                                     visit_textures(read, [&](const auto&...) { ++textures; });
                                     EXPECT_EQ(textures, 1) << row.name;
                                     expect_refused(material_with(row.gltf, {{"index", 7}}));
                                     expect_refused(material_with(row.gltf, {{"texCoord", 0}}));
                                     if (!row.visible) return;
                                     GltfBuilder invisible = with_texture(material_with(row.gltf, {{"index", 0}}));
                                     EXPECT_FALSE((load(invisible).materials.at(0).*row.field).present()) << row.name;
                                   }});
  EXPECT_GE(count, 7);
}

TEST(GltfMaterial, VolumeAttenuation) {
  const auto volume = [](const json& value) {
    return only_material({{"extensions", {{"KHR_materials_volume", value}}}});
  };
  const Material tinted =
      volume({{"thicknessFactor", 1}, {"attenuationDistance", 2}, {"attenuationColor", {0.5, 1, 0}}});
  EXPECT_TRUE(tinted.volume);
  EXPECT_NEAR(tinted.attenuation.x, std::log(2.0) / 2, 1e-6);
  EXPECT_EQ(tinted.attenuation.y, 0.0f);
  EXPECT_GT(tinted.attenuation.z, 10.0f);
  EXPECT_TRUE(std::isfinite(tinted.attenuation.z));
  const Material clear = volume({{"thicknessFactor", 1}, {"attenuationColor", {0.5, 0.5, 0.5}}}); // infinite distance
  EXPECT_TRUE(clear.volume);
  EXPECT_EQ(clear.attenuation, glm::vec3(0));
  EXPECT_FALSE(volume({{"attenuationDistance", 1}, {"attenuationColor", {0, 0, 0}}}).volume); // thin
  EXPECT_THROW(volume({{"thicknessFactor", 1}, {"attenuationDistance", 0}}), Error);
}

// What a deep body reflects is inverted to the albedo of one event: 1 stays 1, 0 stays 0, in between it is higher.
TEST(GltfMaterial, VolumeScattering) {
  const Material m = only_material(
      {{"extensions",
        {{"KHR_materials_volume",
          {{"thicknessFactor", 1}, {"attenuationDistance", 0.5}, {"attenuationColor", {0.1, 0.1, 0.1}}}},
         {"KHR_materials_volume_scatter", {{"multiscatterColor", {1.0, 0.5, 0.0}}, {"scatterAnisotropy", 0.2}}}}}});
  const float extinction = m.attenuation.x;
  EXPECT_NEAR(extinction, std::log(10.0) / 0.5, 1e-5);
  EXPECT_NEAR(m.scattering.x / extinction, 1.0, 1e-3);
  EXPECT_GT(m.scattering.y / extinction, 0.8);
  EXPECT_LT(m.scattering.y / extinction, 1.0);
  EXPECT_NEAR(m.scattering.z / extinction, 0.0, 2e-2);
  EXPECT_EQ(m.scattering_anisotropy, 0.2f);
  const Material hollow =
      only_material({{"extensions", {{"KHR_materials_volume_scatter", {{"multiscatterColor", {1.0, 1.0, 1.0}}}}}}});
  EXPECT_EQ(hollow.scattering, glm::vec3(0.0f)) << "there is no volume";
}

TEST(GltfMaterial, SpecularGlossinessIsConverted) {
  const Material m = load(with_texture({{"extensions",
                                         {{"KHR_materials_pbrSpecularGlossiness",
                                           {{"diffuseFactor", {0.1, 0.2, 0.3, 0.4}},
                                            {"specularFactor", {0.5, 0.6, 0.7}},
                                            {"glossinessFactor", 0.8},
                                            {"diffuseTexture", {{"index", 0}}}}}}}}))
                         .materials.at(0);
  EXPECT_EQ(m.base_color, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
  EXPECT_EQ(m.metallic, 0.0f);
  EXPECT_NEAR(m.roughness, 0.2f, 1e-6f);
  EXPECT_EQ(m.ior, 0.0f) << "F0 is the specular colour itself";
  EXPECT_EQ(m.specular_color, glm::vec3(0.5f, 0.6f, 0.7f));
  EXPECT_TRUE(m.base_color_texture.present());
  EXPECT_THROW(only_material({{"extensions", {{"KHR_materials_pbrSpecularGlossiness", {{"glossinessFactor", "x"}}}}}}),
               Error);
}

TEST(GltfMaterial, UnlitKeepsOnlyTheBaseColor) {
  const Scene scene = load(with_texture({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                                         {"emissiveFactor", {1, 1, 1}},
                                         {"normalTexture", {{"index", 0}}},
                                         {"extensions", {{"KHR_materials_unlit", json::object()}}}}));
  const Material& m = scene.materials.at(0);
  EXPECT_TRUE(m.unlit && m.base_color_texture.present());
  EXPECT_FALSE(m.normal_texture.present());
  EXPECT_EQ(m.emission, glm::vec3(0));
  EXPECT_TRUE(scene.meshes[0].tangents.empty());
}

TEST(GltfMaterial, ValuesOutOfRangeAreClampedWithAWarning) {
  const Scene scene = load(with_material({{"pbrMetallicRoughness", {{"metallicFactor", 3}, {"roughnessFactor", -1}}},
                                          {"extensions", {{"KHR_materials_ior", {{"ior", 0.5}}}}}}));
  EXPECT_EQ(scene.materials[0].metallic, 1.0f);
  EXPECT_EQ(scene.materials[0].roughness, 0.0f);
  EXPECT_EQ(scene.materials[0].ior, 1.0f);
  EXPECT_EQ(warning_count(scene, "clamped"), 3u);
}

TEST(GltfMaterial, OnlyWhatIsUsedIsLoaded) {
  GltfBuilder b = with_texture(json::object());
  b.add("images", {{"uri", "absent.png"}});
  b.add("textures", {{"source", 1}});
  b.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 1}}}}}});
  const Scene scene = load(b); // neither image is touched
  EXPECT_EQ(scene.materials.size(), 1u);
  EXPECT_TRUE(scene.images.empty());
  EXPECT_TRUE(scene.meshes[0].uvs[0].empty());
}

// --- textures ---

TEST(GltfTexture, SlotsSamplersAndRoles) {
  GltfBuilder b = with_texture(
      {{"pbrMetallicRoughness",
        {{"baseColorTexture", {{"index", 1}}}, {"metallicRoughnessTexture", {{"index", 0}, {"texCoord", 1}}}}},
       {"normalTexture", {{"index", 0}, {"scale", 0.5}}},
       {"occlusionTexture", {{"index", 0}}},
       {"emissiveTexture", {{"index", 0}}},
       {"emissiveFactor", {1, 1, 1}}});
  b.add("samplers", {{"magFilter", 9728}, {"wrapS", 33071}, {"wrapT", 33648}});
  b.add("textures", {{"source", 0}, {"sampler", 0}});
  const Scene scene = load(b);
  const Material& m = scene.materials.at(0);
  EXPECT_EQ(scene.images.size(), 1u); // one image, four uses
  EXPECT_TRUE(m.base_color_texture.srgb && m.emission_texture.srgb);
  EXPECT_FALSE(m.metallic_roughness_texture.srgb || m.normal_texture.srgb);
  EXPECT_TRUE(m.base_color_texture.nearest);
  EXPECT_EQ(m.base_color_texture.wrap_u, Wrap::clamp);
  EXPECT_EQ(m.base_color_texture.wrap_v, Wrap::mirror);
  EXPECT_FALSE(m.normal_texture.nearest);
  EXPECT_EQ(m.normal_texture.wrap_u, Wrap::repeat);
  EXPECT_EQ(m.metallic_roughness_texture.uv_set, 1u);
  EXPECT_EQ(m.normal_scale, 0.5f);
  EXPECT_FALSE(m.base_color_texture.transformed());
  EXPECT_EQ(warning_count(scene, "occlusion"), 1u);
  EXPECT_EQ(scene.meshes[0].uvs[1][1], glm::vec2(2, 0));
  EXPECT_EQ(scene.meshes[0].tangents.size(), 3u);
}

TEST(GltfTexture, Transform) {
  const json transform = {{"offset", {0.5, 0.25}}, {"rotation", std::acos(0.0)}, {"scale", {2, 3}}, {"texCoord", 1}};
  const Scene scene = load(
      with_texture({{"pbrMetallicRoughness",
                     {{"baseColorTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}}}}}));
  const TextureSlot& slot = scene.materials.at(0).base_color_texture;
  EXPECT_TRUE(slot.transformed());
  EXPECT_EQ(slot.uv_set, 1u);
  // Scaled to (2, 0), turned by 90 degrees counter-clockwise as seen (v points down), then moved.
  const glm::vec2 u = slot.uv_matrix * glm::vec2(1, 0) + slot.uv_offset;
  EXPECT_NEAR(u.x, 0.5, 1e-6);
  EXPECT_NEAR(u.y, 0.25 - 2, 1e-6);
  const glm::vec2 v = slot.uv_matrix * glm::vec2(0, 1);
  EXPECT_NEAR(v.x, 3, 1e-6);
  EXPECT_NEAR(v.y, 0, 1e-6);
}

// --- sets of texture coordinates ---

// A quad whose TEXCOORD_n are functions of the place, and a material whose textures read the sets that `used` says:
// base colour, metallic-roughness, normal, emission.
using UvSet = glm::vec2 (*)(float x, float y);
GltfBuilder with_sets(const std::vector<UvSet>& sets, const std::vector<int>& used) {
  GltfBuilder b = with_texture(json::object());
  b.root["meshes"][0]["primitives"][0]["attributes"] = {
      {"POSITION", b.floats("VEC3", {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0.25, 1, 0})},
      {"NORMAL", b.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1})}};
  for (std::size_t set = 0; set < sets.size(); ++set) {
    if (!sets[set]) continue;
    std::vector<float> uvs;
    for (const glm::vec2 p : {glm::vec2(0, 0), {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0.25, 1}})
      uvs.insert(uvs.end(), {sets[set](p.x, p.y).x, sets[set](p.x, p.y).y});
    b.primitive()["attributes"]["TEXCOORD_" + std::to_string(set)] = b.floats("VEC2", uvs);
  }
  json& material = b.root["materials"][0];
  material["name"] = "paint";
  material["emissiveFactor"] = {1, 1, 1};
  const char* names[] = {"/pbrMetallicRoughness/baseColorTexture", "/pbrMetallicRoughness/metallicRoughnessTexture",
                         "/normalTexture", "/emissiveTexture"};
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i] >= 0) material[json::json_pointer(names[i])] = {{"index", 0}, {"texCoord", used[i]}};
  return b;
}

const TextureSlot& slot_of(const Scene& scene, std::size_t texture, std::uint32_t material = 0) {
  const Material& m = scene.materials.at(material);
  return *std::array{&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture,
                     &m.emission_texture}[texture];
}

// How far a texture is read from where the set of the file says, at most.
float set_error(const Scene& scene, std::size_t texture, UvSet wanted, const Mesh& mesh, std::uint32_t material = 0) {
  const TextureSlot& slot = slot_of(scene, texture, material);
  EXPECT_TRUE(slot.present() && slot.uv_set < 2);
  float error = 0.0f;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec2 read = slot.uv_matrix * mesh.uvs[slot.uv_set].at(i) + slot.uv_offset;
    error = std::max(error, glm::length(read - wanted(mesh.positions[i].x, mesh.positions[i].y)));
  }
  return error;
}

constexpr UvSet kPlain = [](float x, float y) { return glm::vec2(x, y); };
constexpr UvSet kBent = [](float x, float y) { return glm::vec2(x * y, y); };
constexpr UvSet kCurved = [](float x, float y) { return glm::vec2(x, x * x * y); };
constexpr UvSet kHalf = [](float x, float y) { return glm::vec2(0.5f * x + 0.25f, 0.5f * y); };
constexpr UvSet kTurned = [](float x, float y) { return glm::vec2(3.0f * y - 1.0f, 0.5f - 2.0f * x); };
constexpr UvSet kBentHalf = [](float x, float y) { return glm::vec2(0.5f * x * y + 0.125f, 0.5f * y); };

TEST(GltfUvSets, AnyTwoSetsAreRead) {
  const std::vector<UvSet> sets = {kPlain, kHalf, kBent, kCurved, nullptr, kTurned};
  for (const auto& [first, second] :
       {std::pair{0, 1}, {1, 0}, {0, 2}, {2, 0}, {1, 2}, {2, 3}, {5, 3}, {5, 0}, {2, 2}, {5, 5}}) {
    const Scene scene = load(with_sets(sets, {first, second, first, second}));
    SCOPED_TRACE(testing::Message() << first << " " << second);
    EXPECT_TRUE(scene.warnings.empty());
    for (const std::size_t texture : {0u, 1u, 2u, 3u}) {
      const UvSet wanted = sets[static_cast<std::size_t>(texture % 2 ? second : first)];
      EXPECT_EQ(set_error(scene, texture, wanted, scene.meshes.at(0)), 0.0f) << texture;
      EXPECT_FALSE(slot_of(scene, texture).transformed());
    }
  }
  const Scene plain = load(with_sets(sets, {0, 1}));
  EXPECT_EQ(slot_of(plain, 1).uv_set, 1u) << "TEXCOORD_0 and _1 stay what they are";
}

TEST(GltfUvSets, TangentsAreThoseOfTheNormalTexture) {
  for (const int other : {0, 1, 2}) {
    const Scene scene = load(with_sets({kPlain, kHalf, kBent, kTurned}, {other, -1, 3}));
    ASSERT_GT(scene.meshes.at(0).tangents.size(), 0u);
    // u grows along y alone, v against x: turned, but mirrored no more than the plain set, whose v runs along +y.
    for (const glm::vec4& tangent : scene.meshes.at(0).tangents) {
      EXPECT_NEAR(tangent.y, 1.0f, 1e-6f);
      EXPECT_EQ(tangent.w, -1.0f);
    }
  }
}

TEST(GltfUvSets, SetsThatFollowFromOthersAreTransforms) {
  const std::vector<UvSet> sets = {kPlain, kHalf, kBent, kPlain, kTurned, kBentHalf};
  for (const std::vector<int>& used : {std::vector<int>{0, 1, -1, 2},
                                       {2, 3, 0, 1},
                                       {0, 2, 3, 5},
                                       {5, 4, 3, 2},
                                       {1, 2, 4, 5},
                                       {0, 1, 3, 4},
                                       {4, 5, 0, 1},
                                       {2, 0, 5, 4},
                                       {3, 5, 1, 0},
                                       {0, 2, 1, 4}}) {
    const Scene scene = load(with_sets(sets, used));
    SCOPED_TRACE(testing::Message() << used[0] << used[1] << used[2] << used[3]);
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.counts().begin()->first;
    for (std::size_t texture = 0; texture < 4; ++texture) {
      if (used[texture] < 0) continue;
      EXPECT_LT(set_error(scene, texture, sets[static_cast<std::size_t>(used[texture])], scene.meshes.at(0)), 1e-6f)
          << texture;
    }
    EXPECT_FALSE(slot_of(scene, 2).transformed()) << "tangents are those of the set itself";
  }
}

// A transform of the texture comes after that of the set.
TEST(GltfUvSets, TransformsAreJoined) {
  GltfBuilder b = with_sets({kPlain, kHalf, kBent}, {0, 2, -1, 1});
  b.root["materials"][0]["emissiveTexture"]["extensions"]["KHR_texture_transform"] = {{"scale", {4, 2}},
                                                                                      {"offset", {0.5, 0}}};
  const Scene scene = load(b);
  const UvSet wanted = [](float x, float y) {
    return 4.0f * glm::vec2(0.5f * x + 0.25f, 0.25f * y) + glm::vec2(0.5f, 0.0f);
  };
  EXPECT_LT(set_error(scene, 3, wanted, scene.meshes.at(0)), 1e-6f);
  EXPECT_EQ(set_error(scene, 1, kBent, scene.meshes.at(0)), 0.0f);
}

TEST(GltfUvSets, AThirdSetOfItsOwnIsToldByName) {
  const Scene scene = load(with_sets({kPlain, kCurved, kBent}, {0, 1, -1, 2}));
  EXPECT_EQ(set_error(scene, 0, kPlain, scene.meshes.at(0)), 0.0f);
  EXPECT_EQ(set_error(scene, 1, kCurved, scene.meshes.at(0)), 0.0f);
  EXPECT_FALSE(slot_of(scene, 3).present());
  EXPECT_EQ(scene.materials[0].emission, glm::vec3(0.0f)) << "rather dark than bright all over";
  EXPECT_EQ(warning_count(scene, "emissiveTexture of material 'paint' left out: with TEXCOORD_2"), 1u);
  const Scene absent = load(with_sets({kPlain, kCurved, nullptr}, {0, 1, -1, 2}));
  EXPECT_EQ(set_error(
                absent, 3, [](float, float) { return glm::vec2(0.0f); }, absent.meshes.at(0)),
            0.0f);
  EXPECT_EQ(warning_count(absent, "lacks the texture coordinates"), 1u);
}

// Primitives may give one material different sets.
TEST(GltfUvSets, PrimitivesFitTheirOwn) {
  GltfBuilder b = with_sets({kPlain, kHalf, kBent, kTurned}, {0, 2, -1, 1});
  json second = b.primitive(); // whose TEXCOORD_1 is another map
  second["attributes"]["TEXCOORD_1"] = second["attributes"]["TEXCOORD_3"];
  b.root["meshes"][0]["primitives"].push_back(second);
  b.root["meshes"][0]["primitives"].push_back(b.primitive());
  const Scene scene = load(b);
  ASSERT_EQ(scene.materials.size(), 2u);
  ASSERT_EQ(scene.meshes.size(), 1u);
  const auto& primitives = scene.meshes[0].primitives;
  ASSERT_EQ(primitives.size(), 3u);
  EXPECT_EQ(primitives[0].material, primitives[2].material);
  EXPECT_LT(set_error(scene, 3, kHalf, scene.meshes[0], primitives[0].material), 1e-6f);
  EXPECT_LT(set_error(scene, 3, kTurned, scene.meshes[0], primitives[1].material), 1e-6f);
}

TEST(GltfTexture, SpecularAndTransmissionTextures) {
  const json texture = {{"index", 0}, {"texCoord", 1}};
  const Scene scene = load(with_texture(
      {{"extensions",
        {{"KHR_materials_specular", {{"specularTexture", texture}, {"specularColorTexture", texture}}},
         {"KHR_materials_transmission", {{"transmissionFactor", 1}, {"transmissionTexture", texture}}}}}}));
  const Material& m = scene.materials.at(0);
  EXPECT_TRUE(m.specular_texture.present() && m.specular_color_texture.present() && m.transmission_texture.present());
  EXPECT_TRUE(m.specular_color_texture.srgb);
  EXPECT_FALSE(m.specular_texture.srgb || m.transmission_texture.srgb);
  EXPECT_EQ(m.transmission_texture.uv_set, 1u);
}

TEST(GltfTexture, GivenTangentsAreKeptAndBadOnesRepaired) {
  GltfBuilder b = with_texture({{"normalTexture", {{"index", 0}}}});
  b.primitive()["attributes"]["NORMAL"] = b.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
  b.primitive()["attributes"]["TANGENT"] = b.floats("VEC4", {0, 2, 0, -1, 0, 0, 1, 1, 0, 0, 0, 0});
  const Scene scene = load(b);
  EXPECT_EQ(scene.meshes[0].tangents[0], glm::vec4(0, 1, 0, -1));
  EXPECT_EQ(scene.meshes[0].tangents[1].z, 0.0f);
  EXPECT_EQ(warning_count(scene, "tangent"), 2u);
  b.primitive()["attributes"].erase("NORMAL");                      // then given tangents must be ignored
  EXPECT_EQ(load(b).meshes[0].tangents[0], glm::vec4(1, 0, 0, -1)); // v runs along +y, so this one is mirrored
}

// --- extensions ---

TEST(GltfExtensions, UnknownUsedOnesAreOneWarning) {
  GltfBuilder b = with_material({{"extensions", {{"KHR_materials_retroreflection", {{"factor", 1}}}}}});
  b.root["extensionsUsed"] = {"KHR_materials_retroreflection", "EXT_mystery", "KHR_xmp_json_ld",
                              "KHR_materials_variants"};
  const Scene scene = load(b);
  ASSERT_EQ(scene.warnings.counts().size(), 1u);
  EXPECT_NE(scene.warnings.counts().begin()->first.find("KHR_materials_retroreflection (a draft), EXT_mystery"),
            std::string::npos);
  EXPECT_EQ(scene.warnings.counts().begin()->first.find("xmp"), std::string::npos);
  EXPECT_EQ(scene.extensions_used.size(), 4u);
}

// --- images ---

using Texels = std::vector<std::uint8_t>;

// Loads an image file through a scene.
Image through_file(const std::string& name, const std::vector<std::uint8_t>& file) {
  TempFolder folder;
  folder.write(name, {file.begin(), file.end()});
  GltfBuilder b = with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  b.add("images", {{"uri", name}});
  b.add("textures", {{"source", 0}});
  return load_gltf(folder.write("scene.gltf", b.json())).images.at(0);
}

// A row of texels as a PNG file.
std::vector<std::uint8_t> png_of(std::uint32_t channels, const Texels& texels) {
  const auto count = static_cast<std::uint32_t>(texels.size());
  return encode_png({.shape = {count / channels, 1, channels}, .bytes = texels, .words = {}});
}

TEST(GltfImage, ChannelsBecomeRgbaUnchanged) {
  EXPECT_EQ(through_file("grey.png", png_of(1, {51, 255})).bytes, (Texels{51, 51, 51, 255, 255, 255, 255, 255}));
  EXPECT_EQ(through_file("alpha.png", png_of(2, {51, 102})).bytes, (Texels{51, 51, 51, 102}));
  EXPECT_EQ(through_file("rgb.png", png_of(3, {255, 51, 102})).bytes, (Texels{255, 51, 102, 255}));
  // Neither premultiplied nor lost where alpha is zero.
  EXPECT_EQ(through_file("rgba.png", png_of(4, {255, 51, 102, 0, 153, 204, 51, 51})).bytes,
            (Texels{255, 51, 102, 0, 153, 204, 51, 51}));
}

TEST(GltfImage, PalettesWithTransparency) {
  const Scene scene = load(with_texture({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}));
  EXPECT_EQ(scene.images.at(0).bytes, (Texels{255, 0, 0, 255, 0, 128, 255, 51}));
  EXPECT_EQ(scene.images[0].name, "palette");
  EXPECT_EQ(scene.images[0].width, 2u);
  EXPECT_EQ(scene.images[0].height, 1u);
}

TEST(GltfImage, SixteenBitsBecomeFloats) {
  const std::vector<std::uint8_t> file = encode_png({.shape = {1, 1, 3}, .bytes = {}, .words = {65535, 16384, 1}});
  const Image image = through_file("deep.png", file);
  EXPECT_TRUE(image.bytes.empty());
  ASSERT_EQ(image.floats.size(), 4u);
  EXPECT_EQ(image.floats[0], 1.0f);
  EXPECT_NEAR(image.floats[1], 0.25f, 1e-5f);
  EXPECT_NEAR(image.floats[2], 1.0f / 65535, 1e-8f);
  EXPECT_EQ(image.floats[3], 1.0f);
}

TEST(GltfImage, OfSeveralBadOnesTheFirstIsNamed) {
  GltfBuilder b = with_material(
      {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 1}}}}}});
  for (const char* name : {"first", "second"}) {
    b.add("images",
          {{"name", name}, {"bufferView", b.view("no picture " + std::string(name))}, {"mimeType", "image/png"}});
    b.add("textures", {{"source", b.root["images"].size() - 1}});
  }
  for (int i = 0; i < 20; ++i) try {
      load(b);
      ADD_FAILURE() << "loaded";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("image 'first'"), std::string::npos) << error.what();
    }
}

TEST(GltfImage, Jpeg) {
  const Image jpeg =
      through_file("grey.jpg", encode_jpeg({.shape = {16, 1, 3}, .bytes = Texels(3 * 16, 102), .words = {}}));
  ASSERT_EQ(jpeg.bytes.size(), 64u);
  EXPECT_NEAR(jpeg.bytes[0], 102, 2);
  EXPECT_EQ(jpeg.bytes[3], 255);
}

TEST(GltfImage, WebpKeepsItsColorsBesideAlpha) {
  GltfBuilder b = with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  b.add("images", {{"bufferView", b.view(std::string(kWebp, sizeof(kWebp) - 1))}});
  b.add("textures", {{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}});
  const Texels bytes = load(b).images.at(0).bytes;
  const Texels expected{102, 51, 204, 128, 255, 0, 0, 255};
  ASSERT_EQ(bytes.size(), expected.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) EXPECT_EQ(bytes[i], expected[i]) << i;
}

// A KTX2 file of one texel.
std::string ktx_of(std::uint32_t vk_format, test::Bytes level, std::uint8_t transfer = 1) {
  test::KtxFile file;
  file.vk_format = vk_format;
  file.level = std::move(level);
  file.transfer = transfer;
  const test::Bytes bytes = file.bytes();
  return {bytes.begin(), bytes.end()};
}

// A material whose property `slot` has a texture of a KTX2 file in a buffer view.
GltfBuilder with_ktx(const std::string& file, const char* slot = "") {
  const json texture = {{"index", 0}};
  const bool is_base = !*slot;
  GltfBuilder b = with_material(is_base ? json{{"pbrMetallicRoughness", {{"baseColorTexture", texture}}}}
                                        : json{{slot, texture}, {"emissiveFactor", {1, 1, 1}}});
  b.add("images", {{"bufferView", b.view(file)}, {"mimeType", "image/ktx2"}, {"name", "ktx"}});
  b.add("textures", {{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}});
  b.root["extensionsUsed"] = {"KHR_texture_basisu"};
  return b;
}

TEST(GltfKtx, IsPreferredToItsFallback) {
  GltfBuilder b = with_ktx(ktx_of(43, {1, 2, 3, 4}, 2));
  b.add("images", {{"uri", "missing.png"}}); // not even looked for
  b.root["textures"][0]["source"] = 1;
  EXPECT_EQ(load(b).images.at(0).bytes, (Texels{1, 2, 3, 4}));
  EXPECT_TRUE(load(b).warnings.empty());
  b.root["extensionsRequired"] = {"KHR_texture_basisu"};
  b.root["textures"][0].erase("source");
  EXPECT_EQ(load(b).images.at(0).bytes, (Texels{1, 2, 3, 4}));
}

TEST(GltfKtx, PlainTexturesMayNameOneToo) {
  const std::string file = ktx_of(43, {1, 2, 3, 4}, 2);
  EXPECT_EQ(through_file("color.ktx2", {file.begin(), file.end()}).bytes, (Texels{1, 2, 3, 4}));
}

// The slot decides, as for every image; a descriptor that says otherwise is a warning.
TEST(GltfKtx, SlotsDecideHowBytesAreRead) {
  const Scene color = load(with_ktx(ktx_of(37, {1, 2, 3, 4}, 1)));
  EXPECT_TRUE(color.materials.at(0).base_color_texture.srgb);
  EXPECT_EQ(warning_count(color, "image 'ktx' says that it is linear, but a material reads it as sRGB"), 1u);
  const Scene data = load(with_ktx(ktx_of(43, {1, 2, 3, 4}, 2), "normalTexture"));
  EXPECT_FALSE(data.materials.at(0).normal_texture.srgb);
  EXPECT_EQ(warning_count(data, "image 'ktx' says that it is sRGB, but a material reads it as linear"), 1u);
  EXPECT_TRUE(load(with_ktx(ktx_of(37, {1, 2, 3, 4}, 1), "normalTexture")).warnings.empty());
}

// Halves 4, -1 and infinity: radiance where light is emitted, at most 1 where it is reflected, linear in both.
TEST(GltfKtx, FloatsAreLinear) {
  const test::Bytes halves = {0x00, 0x44, 0x00, 0xbc, 0x00, 0x7c, 0x00, 0x44};
  const Scene emitted = load(with_ktx(ktx_of(97, halves), "emissiveTexture"));
  EXPECT_FALSE(emitted.materials.at(0).emission_texture.srgb);
  EXPECT_EQ(emitted.images.at(0).floats, (std::vector<float>{4, 0, 65504, 1}));
  EXPECT_EQ(warning_count(emitted, "negative, not finite"), 2u);
  const Scene reflected = load(with_ktx(ktx_of(97, halves)));
  EXPECT_FALSE(reflected.materials.at(0).base_color_texture.srgb);
  EXPECT_EQ(reflected.images.at(0).floats, (std::vector<float>{1, 0, 1, 1}));
}

// Slots that are read anew know it too, and so do those of another variant.
TEST(GltfKtx, FloatsStayLinearInAnOpenFile) {
  GltfBuilder b = with_ktx(ktx_of(97, {0x00, 0x44, 0x00, 0x38, 0x00, 0x3c, 0x00, 0x44}));
  b.add("materials", b.root["materials"][0]);
  b.root["materials"][1]["doubleSided"] = true;
  b.root["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "both"}}};
  b.primitive()["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {0}}}};
  TempFolder folder;
  GltfFile file(folder.write("scene.gltf", b.json()));
  Scene scene = file.load();
  for (const LoadOptions& options :
       {LoadOptions{.variant = "both"}, LoadOptions{.shutter = std::pair(0.0, 0.0)}, LoadOptions{}}) {
    scene = file.pose(options, std::move(scene));
    for (const Material& material : scene.materials) EXPECT_FALSE(material.base_color_texture.srgb);
    EXPECT_EQ(scene.images.at(0).floats, (std::vector<float>{1, 0.5f, 1, 1}));
    EXPECT_EQ(scene.images.size(), 1u);
  }
}

TEST(GltfKtx, WordsAreReadAsTheyAreInPng) {
  const Scene scene = load(with_ktx(ktx_of(91, {255, 255, 0, 0, 0, 128, 255, 255}, 2)));
  EXPECT_TRUE(scene.materials.at(0).base_color_texture.srgb);
  EXPECT_EQ(scene.images.at(0).floats, (std::vector<float>{1, 0, 32768.0f / 65535, 1}));
}

TEST(GltfKtx, PremultipliedAlphaIsAWarning) {
  test::KtxFile file;
  file.vk_format = 43;
  file.transfer = 2;
  file.flags = 1;
  const test::Bytes bytes = file.bytes();
  EXPECT_EQ(warning_count(load(with_ktx({bytes.begin(), bytes.end()})), "multiplied by alpha"), 1u);
}

TEST(GltfKtx, BadFilesAreRefusedByName) {
  const auto refusal_of = [](const std::string& file) -> std::string {
    try {
      load(with_ktx(file));
    } catch (const Error& error) {
      return error.what();
    }
    return "was accepted";
  };
  const std::string sound = ktx_of(43, {1, 2, 3, 4}, 2);
  EXPECT_NE(refusal_of(sound.substr(0, 90)).find("image 'ktx' is damaged or cut short ("), std::string::npos);
  EXPECT_NE(refusal_of(sound.substr(0, 90)).find("; replace the image"), std::string::npos);
  std::string huge = sound;
  huge[22] = huge[26] = 1; // 65537 x 65537
  EXPECT_NE(refusal_of(huge).find("image 'ktx' has 65537 x 65537 texels; scale it down"), std::string::npos);
  EXPECT_NE(refusal_of(ktx_of(2, {1})).find("Vulkan's format 2"), std::string::npos);
}

} // namespace
} // namespace wavepath
