// Lights: intervals, weights by power and group, and densities on which estimation and sampling agree.
#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <random>
#include <span>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/scene/pack/emission.h"
#include "host/scene/pack/features.h"
#include "host/scene/pack/intervals.h"
#include "host/scene/pack/pack.h"
#include "host/scene/usage.h"
#include "tests/scene_builder.h"

namespace wavepath {
namespace {

constexpr double kPi = std::numbers::pi;

glm::dmat4 moved(double x, double y, double z) { return glm::translate(glm::dmat4(1.0), glm::dvec3(x, y, z)); }

std::vector<std::uint32_t> ends_of(const PackedScene& packed) {
  std::vector<std::uint32_t> ends;
  for (const gpu::Light& light : packed.lights) ends.push_back(light.end);
  return ends;
}

// `probability` of every light is what its interval gives it, and all of them make one.
void expect_consistent(const PackedScene& packed) {
  const std::vector<std::uint32_t> ends = ends_of(packed);
  double sum = 0.0;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    EXPECT_EQ(packed.lights[i].probability, static_cast<float>(interval_probability(ends, i))) << i;
    sum += packed.lights[i].probability;
  }
  EXPECT_NEAR(sum, 1.0, 1e-6);
}

// The light of a triangle, by the copy that is at `item` and the instance; null if it has none.
const gpu::Light* light_of(const PackedScene& packed, std::uint32_t item, std::uint32_t instance = 0) {
  const std::uint32_t light = packed.triangles[item].light;
  if (light == gpu::kNone) return nullptr;
  return &packed.lights[(packed.root_is_top ? packed.instances[instance].first_light : 0) + light];
}

double world_area(const PackedScene& packed, const gpu::Light& light) {
  const gpu::Triangle& t = packed.triangles[light.triangle];
  glm::dmat3 linear(1.0);
  if (packed.root_is_top)
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        linear[column][row] = packed.instances[light.instance].world_from_object[row][column];
  return 0.5 * glm::length(glm::cross(linear * glm::dvec3(t.v1 - t.v0), linear * glm::dvec3(t.v2 - t.v0)));
}

Material emitter(float radiance) {
  Material material = plain_material();
  material.emission = glm::vec3(radiance);
  material.double_sided = false;
  return material;
}

PunctualLight punctual(LightKind kind, float intensity) {
  PunctualLight light;
  light.kind = kind;
  light.intensity = glm::vec3(intensity);
  return light;
}

TEST(Intervals, ReproduceTheirWeights) {
  const std::vector<double> weights{0.0, 1.0, 2.0, 3.0, 4.0, 0.0, 30.0, 0.0};
  const std::vector<std::uint32_t> ends = build_intervals(weights);
  for (std::size_t i = 0; i < weights.size(); ++i) EXPECT_NEAR(interval_probability(ends, i), weights[i] / 40.0, 1e-8);
  for (const std::size_t zero : {0u, 5u, 7u}) EXPECT_EQ(interval_probability(ends, zero), 0.0); // never, not seldom
  EXPECT_EQ(ends.back(), 0xffffffffu);
}

TEST(Intervals, LeaveNoWeightWithoutAnInteger) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> exponent(-12.0, 12.0);
  std::vector<double> weights(100000);
  double total = 0.0, sum = 0.0;
  for (double& weight : weights) total += weight = std::pow(10.0, exponent(random));
  const std::vector<std::uint32_t> ends = build_intervals(weights);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double probability = interval_probability(ends, i), fraction = weights[i] / total;
    ASSERT_GT(probability, 0.0);
    ASSERT_NEAR(probability, fraction,
                2.4e-5 * fraction + 2.0 / 4294967295.0); // rounding, and the integer that each has
    sum += probability;
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
}

TEST(Intervals, AreNoneWithoutWeight) {
  EXPECT_TRUE(build_intervals({}).empty());
  EXPECT_TRUE(build_intervals(std::vector<double>(3, 0.0)).empty());
  EXPECT_EQ(build_intervals(std::vector<double>{5.0}), (std::vector<std::uint32_t>{0xffffffffu}));
}

// Cuts bound what every integer picks, and hold no more entries than they must.
TEST(Intervals, HaveCutsThatHoldWhatIsPicked) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (const std::size_t count : {1u, 2u, 5u, 8u, 24u, 1000u, 1024u, 65535u, 65536u, 200000u}) {
    SCOPED_TRACE(count);
    std::vector<double> weights(count);
    for (std::size_t i = 0; i < count; ++i) weights[i] = i % 3 == 1 ? 0.0 : uniform(random);
    weights[count / 2] = 1e3; // most integers
    if (count > 4) weights[0] = weights[1] = weights[count - 1] = weights[count - 2] = 0.0;
    const std::vector<std::uint32_t> ends = build_intervals(weights), cuts = cut_intervals(ends);
    ASSERT_EQ(cuts.size(), cut_count(count));
    ASSERT_TRUE(std::has_single_bit(cuts.size()));
    const std::uint64_t integers = (std::uint64_t{1} << 32) / cuts.size();
    const int coarse = count < 65536 ? 0 : std::bit_width(count) - 16;
    const auto picked = [&](std::uint64_t u) {
      const auto entry =
          std::ranges::upper_bound(ends, static_cast<std::uint32_t>(std::min<std::uint64_t>(u, 0xfffffffe)));
      return static_cast<std::uint32_t>(entry - ends.begin()) >> coarse;
    };
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      ASSERT_EQ(cuts[i] & 0xffff, picked(i * integers)) << i;
      if (i + 1 < cuts.size()) {
        ASSERT_EQ(cuts[i] >> 16, picked((i + 1) * integers - 1)) << i;
      }
    }
    EXPECT_GE(cuts.back() >> 16, picked(0xfffffffe)); // entries without weight behind it
  }
}

TEST(Lights, AreWeightedByPower) {
  Scene scene = triangle_scene(); // radius sqrt(1/2), area 1/2
  scene.materials[0] = emitter(2.0f);
  scene.lights = {punctual(LightKind::point, 3.0f), punctual(LightKind::spot, 5.0f),
                  punctual(LightKind::directional, 7.0f)};
  scene.lights[1].inner_cone = 0.3;
  scene.lights[1].outer_cone = 0.6;
  const PackedScene packed = pack(scene);
  ASSERT_EQ(packed.lights.size(), 4u);
  expect_consistent(packed);
  // The spot's solid angle, integrated numerically over its falloff.
  double spot = 0.0;
  const int steps = 100000;
  for (int i = 0; i < steps; ++i) {
    const double c = -1.0 + 2.0 * (i + 0.5) / steps;
    const double ramp = std::clamp((c - std::cos(0.6)) / (std::cos(0.3) - std::cos(0.6)), 0.0, 1.0);
    spot += 2 * kPi * ramp * ramp * 2.0 / steps;
  }
  const double powers[] = {2.0 * kPi * 0.5, 4 * kPi * 3.0, 5.0 * spot, 7.0 * kPi * 0.5};
  const double local = powers[0] + powers[1] + powers[2], total = local + powers[3];
  // Half by power, half to the two groups alike.
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(packed.lights[i].probability, 0.5 * powers[i] / total + 0.25 * (i < 3 ? powers[i] / local : 1.0), 1e-6)
        << i;
  EXPECT_EQ(packed.features,
            gpu::kFeatureCull | gpu::kFeatureEmission | gpu::kFeatureTriangleLights | gpu::kFeaturePunctualLights);
}

TEST(Lights, ArePlacedAndTurnedForTheKernels) {
  Scene scene = triangle_scene();
  scene.lights = {punctual(LightKind::point, 1.0f), punctual(LightKind::spot, 1.0f),
                  punctual(LightKind::directional, 1.0f)};
  for (PunctualLight& light : scene.lights) {
    light.position = {1e7 + 1.5, 0.5, 2.0};
    light.direction = {0.6, 0.0, -0.8};
  }
  scene.instances[0].world_from_object = moved(1e7, 0, 0);
  const PackedScene packed = pack(scene);
  ASSERT_EQ(packed.lights.size(), 3u);
  EXPECT_EQ(packed.lights[0].kind, gpu::kLightPoint);
  EXPECT_EQ(packed.lights[0].position, glm::vec3(1.0f, 0.0f, 2.0f));
  EXPECT_EQ(packed.lights[1].direction, glm::vec3(0.6f, 0.0f, -0.8f)); // the axis, away from the light
  EXPECT_EQ(packed.lights[2].direction, glm::vec3(-0.6f, 0.0f, 0.8f)); // towards the light
  const gpu::Light& spot = packed.lights[1];
  const float outer = static_cast<float>(std::cos(scene.lights[1].outer_cone));
  EXPECT_NEAR(1.0f * spot.spot_scale + spot.spot_offset, 1.0f, 1e-6f); // inner cone 0
  EXPECT_NEAR(outer * spot.spot_scale + spot.spot_offset, 0.0f, 1e-6f);
}

TEST(Lights, SpotsWithAHardEdgeStayFinite) {
  Scene scene = triangle_scene();
  scene.lights = {punctual(LightKind::spot, 1.0f), punctual(LightKind::point, 1.0f)};
  scene.lights[0].inner_cone = scene.lights[0].outer_cone = 0.5;
  const PackedScene packed = pack(scene);
  EXPECT_FLOAT_EQ(packed.lights[0].spot_scale, 1000.0f);
  EXPECT_FLOAT_EQ(packed.lights[0].spot_offset, static_cast<float>(-std::cos(0.5) * 1000.0));
  const double cap = 2 * kPi * (1 - std::cos(0.5));
  EXPECT_NEAR(packed.lights[0].probability / packed.lights[1].probability, cap / (4 * kPi), 0.01);
}

TEST(Lights, EveryBakedTriangleIsFoundWithTheDensityItCarries) {
  Scene scene;
  scene.materials = {emitter(1.0f), emitter(4.0f), plain_material()};
  scene.materials[1].double_sided = true;
  add_instance(scene, add_mesh(scene, kUnitTriangle, 0), glm::scale(glm::dmat4(1.0), glm::dvec3(-3.0, 2.0, 1.0)));
  add_instance(scene, add_mesh(scene, kUnitTriangle, 1), moved(0, 0, 1));
  add_instance(scene, add_mesh(scene, kUnitTriangle, 2), moved(0, 0, 2));
  const PackedScene packed = pack(scene);
  ASSERT_EQ(packed.lights.size(), 2u);
  expect_consistent(packed);
  for (const gpu::Light& light : packed.lights)
    EXPECT_NEAR(light.probability / world_area(packed, light) / light.pdf_area, 1.0, 1e-6);
  for (std::uint32_t i = 0; i < packed.triangles.size(); ++i) {
    const float power[] = {1.0f * 6.0f, 4.0f * 2.0f, 0.0f}; // radiance times area, both sides of the second
    const float area[] = {3.0f, 0.5f, 1.0f};
    const std::uint32_t material = packed.triangles[i].surface & gpu::kTriangleMaterialMask;
    const gpu::Light* light = light_of(packed, i);
    ASSERT_EQ(light != nullptr, material < 2);
    if (light == nullptr) continue;
    EXPECT_NEAR(light->pdf_area, power[material] / 2.0f / 7.0f / area[material], 1e-6f);
  }
}

TEST(Lights, InstancesHaveLightsOfTheirOwn) {
  Scene scene;
  scene.materials = {emitter(1.0f), emitter(10.0f)};
  const std::uint32_t shared = add_mesh(scene, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  add_instance(scene, shared, moved(5, 0, 0));
  add_instance(scene, shared, glm::scale(moved(-5, 0, 0), glm::dvec3(7.0, 0.3, -2.0)));
  add_instance(scene, shared, glm::rotate(moved(0, 9, 0), 1.1, glm::dvec3(1, 2, 3)));
  add_instance(scene, add_mesh(scene, kUnitTriangle, 1));
  scene.lights = {punctual(LightKind::point, 0.5f)};
  const PackedScene packed = pack(scene);
  ASSERT_EQ(packed.lights.size(), 3u * 2u + 1u + 1u);
  expect_consistent(packed);
  double total_area[2] = {0.0, 0.0};
  for (const gpu::Light& light : packed.lights) {
    if (light.kind != gpu::kLightTriangle) continue;
    const gpu::Triangle& triangle = packed.triangles[light.triangle];
    EXPECT_NEAR(light.probability / world_area(packed, light) / light.pdf_area, 1.0, 1e-6);
    EXPECT_EQ(light_of(packed, light.triangle, light.instance), &light);
    total_area[triangle.surface & gpu::kTriangleMaterialMask] += world_area(packed, light);
  }
  const double power = kPi * (total_area[0] + 10.0 * total_area[1]) + 4 * kPi * 0.5;
  EXPECT_NEAR(packed.lights.back().probability, 4 * kPi * 0.5 / power, 1e-6);
}

TEST(Lights, LeaveUnlitAndDarkMaterialsAlone) {
  Scene scene = triangle_scene();
  scene.materials[0] = emitter(1.0f);
  scene.materials[0].unlit = true;
  const PackedScene unlit = pack(scene);
  EXPECT_TRUE(unlit.lights.empty());
  EXPECT_EQ(unlit.triangles[0].light, gpu::kNone);
  EXPECT_EQ(unlit.features, gpu::kFeatureCull | gpu::kFeatureEmission | gpu::kFeatureAlpha);
  scene.materials[0] = plain_material();
  scene.lights = {punctual(LightKind::point, 0.0f)};
  EXPECT_TRUE(pack(scene).lights.empty());
}

TEST(Lights, AreNotPackedForBsdfSampling) {
  Scene scene = triangle_scene();
  scene.materials[0] = emitter(1.0f);
  scene.lights = {punctual(LightKind::point, 1.0f)};
  scene.environment.radiance = glm::vec3(1.0f);
  const PackedScene packed = pack(scene, {.direct = gpu::kDirectBsdf});
  EXPECT_TRUE(packed.lights.empty());
  EXPECT_EQ(packed.triangles[0].light, gpu::kNone);
  EXPECT_EQ(packed.environment_probability, 0.0f);
  EXPECT_EQ(packed.environment_radiance, glm::vec3(1.0f)); // still shines on rays that leave
  EXPECT_EQ(packed.features, gpu::kFeatureCull | gpu::kFeatureEmission | gpu::kFeatureEnvironment);
  EXPECT_FALSE(scene.warnings.empty());
}

TEST(Lights, SampleConstantEnvironmentsOnlyWhereNothingElseDoes) {
  Scene scene = triangle_scene();
  scene.environment.radiance = glm::vec3(2.0f);
  EXPECT_TRUE(pack(scene).lights.empty());
  const PackedScene nee = pack(scene, {.direct = gpu::kDirectNee});
  ASSERT_EQ(nee.lights.size(), 1u);
  EXPECT_EQ(nee.lights[0].kind, gpu::kLightEnvironment);
  EXPECT_EQ(nee.environment_probability, 1.0f);
}

TEST(Lights, SampleEnvironmentMapsByTheirPower) {
  Scene scene = triangle_scene();
  scene.environment.radiance = glm::vec3(2.0f);
  scene.environment.width = 8;
  scene.environment.height = 4;
  scene.environment.map.assign(32, glm::vec3(0.5f));
  scene.lights = {punctual(LightKind::point, 1.0f)};
  const PackedScene packed = pack(scene);
  ASSERT_EQ(packed.lights.size(), 2u);
  expect_consistent(packed);
  const double power = 4 * kPi * kPi * 0.5 * 1.0; // 4 pi^2 r^2 L
  EXPECT_NEAR(packed.environment_probability, 0.25 + 0.5 * power / (power + 4 * kPi), 1e-6);
  EXPECT_EQ(packed.environment_probability, packed.lights[1].probability);
  EXPECT_EQ(packed.features, gpu::kFeaturePunctualLights | gpu::kFeatureEnvironment | gpu::kFeatureEnvironmentMap);
}

// Eight triangles side by side, each over an eighth of a texture of 64 x 1 texels.
Scene textured_strip(const std::vector<std::uint8_t>& grey, Wrap wrap = Wrap::clamp, bool nearest = true) {
  Scene scene;
  scene.materials = {emitter(1.0f)};
  scene.images.push_back({"strip", 64, 1, {}, {}});
  for (const std::uint8_t g : grey) scene.images[0].bytes.insert(scene.images[0].bytes.end(), {g, g, g, 255});
  scene.materials[0].emission_texture.image = 0;
  scene.materials[0].emission_texture.wrap_u = wrap;
  scene.materials[0].emission_texture.nearest = nearest;
  std::vector<glm::vec3> positions;
  for (int i = 0; i < 8; ++i)
    for (const glm::vec3& p : kUnitTriangle) positions.push_back(p + glm::vec3(static_cast<float>(i), 0, 0));
  add_instance(scene, add_mesh(scene, positions));
  for (const glm::vec3& p : positions) scene.meshes[0].uvs[0].push_back({p.x / 8.0f, 0.5f});
  return scene;
}

// Which of the eight are lights, by their place.
std::vector<float> pdf_by_part(const PackedScene& packed) {
  std::vector<float> pdf(8, 0.0f);
  for (std::uint32_t i = 0; i < packed.triangles.size(); ++i)
    if (const gpu::Light* light = light_of(packed, i))
      pdf[static_cast<std::size_t>(std::lround(packed.triangles[i].v0.x + packed.origin.x))] = light->pdf_area;
  return pdf;
}

TEST(TexturedLights, FollowTheTexture) {
  std::vector<std::uint8_t> grey(64, 0);
  for (int x = 0; x < 24; ++x)
    grey[static_cast<std::size_t>(x)] = x < 8 ? 255 : 51; // places 0 bright, 1 and 2 a fifth, rest black
  Scene scene = textured_strip(grey);
  const PackedScene packed = pack(scene);
  expect_consistent(packed);
  const std::vector<float> pdf = pdf_by_part(packed);
  EXPECT_NEAR(pdf[0], 1.0 / 1.4 / 0.5, 0.1);
  EXPECT_NEAR(pdf[0] / pdf[2], 5.0, 0.5);
  for (const std::size_t black : {5u, 6u, 7u}) EXPECT_EQ(pdf[black], 0.0f);
  EXPECT_LE(packed.lights.size(), 5u);
}

TEST(TexturedLights, FindASingleLitTexel) {
  for (const Wrap wrap : {Wrap::clamp, Wrap::repeat, Wrap::mirror})
    for (const float shift : {0.0f, -0.2f, 0.2f}) // of the triangles against the texels
      for (int lit = 0; lit < 64; ++lit) {
        std::vector<std::uint8_t> grey(64, 0);
        grey[static_cast<std::size_t>(lit)] = 255;
        Scene scene = textured_strip(grey, wrap, false);
        scene.materials[0].emission_texture.srgb = true;
        for (glm::vec2& uv : scene.meshes[0].uvs[0]) uv.x += shift / 64.0f;
        const std::vector<float> pdf = pdf_by_part(pack(scene));
        // Bilinear interpolation spreads the texel by one to either side: every triangle that it touches must be a
        // light.
        for (int place = 0; place < 8; ++place) {
          const bool touched = lit + 1 >= 8 * place && lit - 1 < 8 * (place + 1);
          if (touched) {
            EXPECT_GT(pdf[static_cast<std::size_t>(place)], 0.0f) << lit << " " << place << " " << shift;
          }
        }
      }
}

TEST(TexturedLights, FollowRepetitionAcrossTheSeam) {
  std::vector<std::uint8_t> grey(64, 0);
  grey[3] = 255;
  Scene scene = textured_strip(grey, Wrap::repeat);
  for (glm::vec2& uv : scene.meshes[0].uvs[0]) uv.x -= 2.0f + 4.0f / 64.0f;
  const std::vector<float> pdf = pdf_by_part(pack(scene)); // place 0 now spans texels 60..67, which are 60..63 and 0..3
  EXPECT_GT(pdf[0], 0.0f);
  EXPECT_EQ(pdf[4], 0.0f);
}

TEST(TexturedLights, ReadMovedSecondCoordinatesInLinearLight) {
  std::vector<std::uint8_t> grey(64, 0);
  for (std::size_t x = 0; x < 32; ++x) grey[x] = x < 16 ? 255 : 188; // sRGB 188 = 0.5029 linear
  Scene scene = textured_strip(grey);
  std::swap(scene.meshes[0].uvs[0], scene.meshes[0].uvs[1]);
  TextureSlot& slot = scene.materials[0].emission_texture;
  slot.srgb = true;
  slot.uv_set = 1;
  slot.uv_matrix = glm::mat2(0.5f, 0.0f, 0.0f, 1.0f); // u' = u/2 reaches the lit half alone
  const PackedScene packed = pack(scene);
  const std::vector<float> pdf = pdf_by_part(packed);
  EXPECT_NEAR(pdf[6] / pdf[1], 0.5029, 1e-3);
  EXPECT_EQ(packed.lights.size(), 8u);
}

TEST(TexturedLights, AreNoneIfTheTextureIsBlack) {
  Scene scene = textured_strip(std::vector<std::uint8_t>(64, 0));
  EXPECT_TRUE(pack(scene).lights.empty());
}

// Two triangles over a texture of 64 x 64 texels, of which 4 x 4 shine.
Scene sign_with_one_lit_block() {
  Scene scene;
  scene.materials = {emitter(1.0f)};
  scene.images.push_back({"sign", 64, 64, {}, {}});
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const std::uint8_t g = x / 4 == 9 && y / 4 == 5 ? 255 : 0;
      scene.images[0].bytes.insert(scene.images[0].bytes.end(), {g, g, g, 255});
    }
  scene.materials[0].emission_texture.image = 0;
  const std::vector<glm::vec3> positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  add_instance(scene, add_mesh(scene, positions));
  for (const glm::vec3& p : positions) scene.meshes[0].uvs[0].push_back({p.x, p.y});
  return scene;
}

// Density of the points of each cell of a triangle, over the mean.
std::vector<double> cell_densities(const PackedScene& packed, const gpu::Light& light) {
  const std::uint32_t depth = light.parts >> gpu::kPartDepthShift;
  if (depth == 0) return {1.0};
  const std::span words = std::span(packed.light_parts).subspan(light.parts & gpu::kFirstPartMask);
  const std::uint32_t count = words[0];
  const std::span picks = words.subspan(1, count), ends = words.subspan(1 + count, count);
  std::vector<double> densities;
  for (std::uint32_t part = 0; part < count; ++part) {
    const double cells = ends[part] - (part > 0 ? ends[part - 1] : 0);
    densities.resize(ends[part], interval_probability(picks, part) / cells * std::exp2(2.0 * depth));
  }
  EXPECT_EQ(densities.size(), std::size_t{1} << 2 * depth);
  return densities;
}

// The cell that has these weights, counted as kernels/light/light_sampling.glsl does, in integers: of 2^24.
std::size_t cell_of(std::uint32_t depth, double b1, double b2) {
  auto x = static_cast<std::int64_t>(b1 * 0x1p24), y = static_cast<std::int64_t>(b2 * 0x1p24);
  const std::int64_t half = 1 << 23;
  std::size_t cell = 0;
  for (std::uint32_t i = 0; i < depth; ++i) {
    const std::size_t quarter = x >= half ? 1 : y >= half ? 2 : x + y > half ? 3 : 0;
    cell = cell << 2 | quarter;
    x = quarter == 3 ? 2 * half - 2 * x : 2 * x - (quarter == 1 ? 2 * half : 0);
    y = quarter == 3 ? 2 * half - 2 * y : 2 * y - (quarter == 2 ? 2 * half : 0);
  }
  return cell;
}

TEST(TexturedLights, AreCutWhereTheTextureVaries) {
  Scene scene = sign_with_one_lit_block();
  const PackedScene packed = pack(scene);
  expect_consistent(packed);
  ASSERT_EQ(packed.lights.size(), 1u); // the block lies in the first triangle alone
  const gpu::Light& light = packed.lights[0];
  EXPECT_NEAR(light.probability / light.pdf_area, world_area(packed, light), 1e-6);
  const std::uint32_t depth = light.parts >> gpu::kPartDepthShift;
  const std::vector<double> densities = cell_densities(packed, light);
  const gpu::Triangle& t = packed.triangles[light.triangle];
  double sum = 0.0;
  for (int i = 0; i < 256; ++i)
    for (int j = 0; j < 256 - i; ++j) {
      const double b1 = (i + 0.33) / 256.0, b2 = (j + 0.33) / 256.0;
      const double density = densities[cell_of(depth, b1, b2)];
      sum += density;
      const glm::dvec3 p =
          (1.0 - b1 - b2) * glm::dvec3(t.v0) + b1 * glm::dvec3(t.v1) + b2 * glm::dvec3(t.v2) + packed.origin;
      if (std::abs(p.x - 38.0 / 64.0) > 4.0 / 64.0 || std::abs(p.y - 22.0 / 64.0) > 4.0 / 64.0) {
        EXPECT_LT(density, 1.0) << p.x << " " << p.y; // 100 times that where it shines
      }
    }
  EXPECT_NEAR(sum / (256 * 257 / 2), 1.0, 0.05);
}

struct Lamp {
  int size, x, y, side; // of the texture, and the lit texels
  Wrap wrap;
  glm::vec2 lo{0.0f}, hi{1.0f}; // texture coordinates
  glm::mat2 matrix{1.0f};
  glm::vec2 offset{0.0f};
  bool second = false; // TEXCOORD_1
  bool nearest = false;
};

Scene scene_of(const Lamp& lamp) {
  Scene scene;
  scene.materials = {emitter(1.0f)};
  scene.images.push_back(
      {"lamp", static_cast<std::uint32_t>(lamp.size), static_cast<std::uint32_t>(lamp.size), {}, {}});
  for (int y = 0; y < lamp.size; ++y)
    for (int x = 0; x < lamp.size; ++x) {
      const bool lit = x >= lamp.x && x < lamp.x + lamp.side && y >= lamp.y && y < lamp.y + lamp.side;
      const std::uint8_t g = lit ? 255 : 0;
      scene.images[0].bytes.insert(scene.images[0].bytes.end(), {g, g, g, 255});
    }
  TextureSlot& slot = scene.materials[0].emission_texture;
  slot = {
      .image = 0, .wrap_u = lamp.wrap, .wrap_v = lamp.wrap, .nearest = lamp.nearest, .uv_set = lamp.second ? 1u : 0u};
  slot.uv_matrix = lamp.matrix;
  slot.uv_offset = lamp.offset;
  const std::vector<glm::vec3> positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  add_instance(scene, add_mesh(scene, positions));
  for (const glm::vec3& p : positions) {
    const glm::vec2 uv = lamp.lo + glm::vec2(p) * (lamp.hi - lamp.lo);
    scene.meshes[0].uvs[0].push_back(lamp.second ? glm::vec2(0.0f) : uv);
    if (lamp.second) scene.meshes[0].uvs[1].push_back(uv);
  }
  return scene;
}

// What a look-up yields: a bilinear filter over an endless row of images.
double lit_at(const Lamp& lamp, const glm::dvec2& place) {
  const auto texel = [&](int i) {
    if (lamp.wrap == Wrap::clamp) return std::clamp(i, 0, lamp.size - 1);
    const int period = lamp.wrap == Wrap::mirror ? 2 * lamp.size : lamp.size;
    i = ((i % period) + period) % period;
    return i < lamp.size ? i : period - 1 - i;
  };
  const auto lit = [&](int x, int y) {
    x = texel(x) - lamp.x, y = texel(y) - lamp.y;
    return x >= 0 && y >= 0 && x < lamp.side && y < lamp.side ? 1.0 : 0.0;
  };
  const glm::dvec2 first = glm::floor(lamp.nearest ? place : place - 0.5), w = place - 0.5 - first;
  const int x = static_cast<int>(first.x), y = static_cast<int>(first.y);
  if (lamp.nearest) return lit(x, y);
  return (1 - w.y) * ((1 - w.x) * lit(x, y) + w.x * lit(x + 1, y)) +
         w.y * ((1 - w.x) * lit(x, y + 1) + w.x * lit(x + 1, y + 1));
}

// Wherever a look-up yields light its point is picked, and by about as much as it shines: of one sample, the square's
// mean is at most 1.2 times the mean's square, where it is 1 for an even lamp (light that arrives is the same from
// everywhere).
void expect_followed(const Lamp& lamp) {
  Scene scene = scene_of(lamp);
  const PackedScene packed = pack(scene);
  expect_consistent(packed);
  double sum = 0.0, squares = 0.0;
  const int n = lamp.size > 64 ? 1024 : 384;
  for (std::uint32_t item = 0; item < packed.triangles.size(); ++item) {
    const gpu::Triangle& t = packed.triangles[item];
    const gpu::Light* light = light_of(packed, item);
    std::vector<double> densities;
    if (light != nullptr) densities = cell_densities(packed, *light);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n - i; ++j) {
        const double b1 = (i + 0.31) / n, b2 = (j + 0.35) / n;
        const glm::dvec3 p =
            (1.0 - b1 - b2) * glm::dvec3(t.v0) + b1 * glm::dvec3(t.v1) + b2 * glm::dvec3(t.v2) + packed.origin;
        glm::dvec2 uv = glm::dvec2(lamp.lo) + glm::dvec2(p) * glm::dvec2(lamp.hi - lamp.lo);
        uv = glm::dmat2(lamp.matrix) * uv + glm::dvec2(lamp.offset);
        const double lit = lit_at(lamp, uv * double(lamp.size));
        if (lit < 1e-6) continue;
        const double density =
            light == nullptr ? 0.0 : light->pdf_area * densities[cell_of(light->parts >> gpu::kPartDepthShift, b1, b2)];
        ASSERT_GT(density, 0.0) << "texel " << uv.x * lamp.size << " " << uv.y * lamp.size << ", lit by " << lit;
        sum += lit, squares += lit * lit / density;
      }
  }
  ASSERT_GT(sum, 0.0);
  const double pieces = double(n) * n;
  EXPECT_LT(squares / pieces / (sum / pieces * sum / pieces), 1.2);
}

TEST(TexturedLights, FollowWhatFilteredLookUpsYield) {
  std::vector<Lamp> lamps;
  for (const Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp}) {
    for (int at = 0; at < 9; ++at) lamps.push_back({64, 24 + at, 16 + at, 1 + at % 4, wrap}); // against cells
    for (const int at : {0, 1, 61, 63}) lamps.push_back({64, at, 30, 1, wrap, {-0.25f, -0.25f}, {1.3f, 1.3f}}); // seams
    lamps.push_back({64, 63, 0, 1, wrap, {-1.5f, 0.5f}, {2.5f, -2.5f}});     // several tiles, mirrored
    lamps.push_back({256, 200, 100, 4, wrap});                               // the reported one
    lamps.push_back({64, 30, 30, 2, wrap, {0.47f, 0.47f}, {0.49f, 0.485f}}); // a corner of it, magnified
    lamps.push_back({64, 0, 0, 2, wrap, {0, 0}, {1, 1}, {0.8f, 0.6f, -0.6f, 0.8f}, {-0.1f, -0.7f}}); // turned
    lamps.push_back({64, 40, 20, 3, wrap, {0, 0}, {1, 1}, {-1.7f, 0, 0, 1.2f}, {0.9f, 0.0f}});       // scaled, mirrored
    lamps.push_back({64, 9, 50, 1, wrap, {0, 0}, {1, 1}, glm::mat2(1.0f), {0, 0}, true});            // TEXCOORD_1
    lamps.push_back({64, 32, 32, 4, wrap, {0, 0}, {1, 1}, glm::mat2(1.0f), {0, 0}, false, true});    // nearest
  }
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    SCOPED_TRACE(i);
    expect_followed(lamps[i]);
    if (HasFatalFailure()) return;
  }
}

TEST(TexturedLights, AreWholeWhereTheTextureIsEven) {
  Scene scene = sign_with_one_lit_block();
  for (std::uint8_t& byte : scene.images[0].bytes) byte = 200;
  const PackedScene packed = pack(scene);
  EXPECT_EQ(packed.lights.size(), 2u);
  EXPECT_TRUE(packed.light_parts.empty());
}

// Kernels are guessed while images are still being decoded.
TEST(TexturedLights, AreCountedByWhatIsKnownOfTheTexture) {
  Scene scene = sign_with_one_lit_block();
  const Usage usage = find_usage(scene);
  for (std::uint8_t& byte : scene.images[0].bytes) byte = 0;
  EXPECT_EQ(count_emitters(scene, usage), 0u);
  scene.images[0].bytes.clear();
  EXPECT_EQ(count_emitters(scene, usage), 2u);
  scene.images.clear();
  EXPECT_EQ(count_emitters(scene, find_usage(scene)), 2u);
  EXPECT_NE(expected_features(scene, gpu::kDirectMis) & gpu::kFeatureTriangleLights, 0u);
}

} // namespace
} // namespace wavepath
