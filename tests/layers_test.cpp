// Materials beyond metallic-roughness on the device: furnaces of rough metal and glass, coats, sheen, films, stretched
// microfacets, diffuse transmission: energy, reciprocity, known answers, and that leaving lobes out changes no bit.
#include <fmt/format.h>

#include "tests/bsdf_probe.h"

namespace wavepath::test {
namespace {

constexpr double kCosines[] = {0.999, 0.8, 0.5, 0.2, 0.05};
constexpr gpu::Feature kAll = gpu::kFeaturesAll | gpu::kLobesAll;

Config seen_from(Config config, double cosine, double azimuth = 0.7) {
  config.wo = direction(cosine, azimuth);
  return config;
}

std::vector<Config> from_all_sides(const std::vector<Config>& materials) {
  std::vector<Config> configs;
  for (const Config& material : materials)
    for (const double cosine : kCosines) configs.push_back(seen_from(material, cosine));
  return configs;
}

// White, so that none may return more light than arrives.
std::vector<Config> zoo() {
  const glm::vec3 tilted = glm::normalize(glm::vec3(0.1f, -0.15f, 1.0f));
  std::vector<Config> configs;
  for (const float coat_alpha : {0.0f, 0.04f, 0.5f}) {
    configs.push_back({.alpha = 0.3f, .coat = 1.0f, .coat_alpha = coat_alpha});
    configs.push_back({.metallic = 1.0f, .alpha = 0.0f, .coat = 0.7f, .coat_alpha = coat_alpha});
    configs.push_back({.metallic = 1.0f, .alpha = 0.4f, .coat = 1.0f, .coat_alpha = coat_alpha});
  }
  configs.push_back({.metallic = 0.5f, .alpha = 0.3f, .coat_normal = tilted, .coat = 1.0f, .coat_alpha = 0.1f});
  for (const float roughness : {0.1f, 0.5f, 1.0f}) {
    configs.push_back({.alpha = 0.5f, .sheen_color = glm::vec3(1.0f), .sheen_roughness = roughness});
    configs.push_back({.specular = 0.0f, .sheen_color = {1.0f, 0.2f, 0.5f}, .sheen_roughness = roughness});
  }
  configs.push_back(
      {.alpha = 0.5f, .sheen_color = glm::vec3(0.5f), .sheen_roughness = 0.4f, .coat = 1.0f, .coat_alpha = 0.01f});
  for (const float nanometres : {100.0f, 400.0f, 800.0f}) {
    configs.push_back({.alpha = 0.2f, .film = 1.0f, .film_nanometres = nanometres});
    configs.push_back({.base_color = glm::vec3(0.9f),
                       .metallic = 1.0f,
                       .alpha = 0.2f,
                       .film = 1.0f,
                       .film_ior = 1.8f,
                       .film_nanometres = nanometres});
  }
  configs.push_back({.metallic = 1.0f, .alpha = 0.1f, .stretched_alpha = {0.6f, 0.1f}});
  configs.push_back({.metallic = 1.0f, .alpha = 0.01f, .stretched_alpha = {0.3f, 0.01f}});
  configs.push_back({.alpha = 0.3f, .diffuse_transmission = 0.6f});
  configs.push_back({.specular = 0.0f, .diffuse_through = {0.9f, 0.5f, 0.1f}, .diffuse_transmission = 1.0f});
  for (const std::uint32_t flags : {kEntering, 0u, kThin}) {
    configs.push_back({.alpha = 0.3f, .transmission = 1.0f, .flags = flags, .coat = 1.0f, .coat_alpha = 0.01f});
    configs.push_back({.alpha = 0.1f, .transmission = 1.0f, .flags = flags, .film = 1.0f});
    configs.push_back({.alpha = 0.7f, .transmission = 1.0f, .flags = flags});
    configs.push_back({.metallic = 0.3f, .alpha = 0.5f, .transmission = 0.6f, .flags = flags});
  }
  return configs;
}

class LayersTest : public VulkanTest {
protected:
  // With the lobes given: kernels that have all of them take seconds to compile.
  std::vector<Drawn> drawn(gpu::Feature lobes, const std::vector<Config>& configs, DrawSettings settings = {}) {
    settings.features = gpu::kFeatureSpecular | gpu::kFeatureTransmission | lobes;
    return draw(device(), configs, settings).drawn;
  }
};

TEST_F(LayersTest, SamplesAreSoundAgreeWithEvalAndKeepEnergy) {
  const std::vector<Config> configs = from_all_sides(zoo());
  const auto all = drawn(gpu::kLobesAll, configs);
  for (std::size_t i = 0; i < configs.size(); ++i) {
    const Drawn& d = all[i];
    const std::string what = fmt::format("material {}, cos {}", i / std::size(kCosines), configs[i].wo.z);
    EXPECT_EQ(d.bad, 0.0) << what;
    EXPECT_LT(d.mismatch, 1e-4) << what;
    const double most = std::max({d.weight.x, d.weight.y, d.weight.z});
    EXPECT_LE(most, 1.002 + 3.0 * d.weight_error) << what;
    EXPECT_GT(most, 0.5) << what;
  }
}

// Rough metal, rough glass and rough panes in a white furnace, seen from either side: at most 1 % is lost.
TEST_F(LayersTest, RoughMicrofacetsReturnAllLight) {
  for (const float ior : {1.5f, 2.4f}) {
    std::vector<Config> materials;
    for (const float roughness : {0.05f, 0.35f, 0.7f, 1.0f}) {
      const float alpha = roughness * roughness;
      if (ior == 1.5f) materials.push_back({.metallic = 1.0f, .alpha = alpha});
      for (const std::uint32_t flags : {kEntering, 0u, kThin})
        materials.push_back({.alpha = alpha, .transmission = 1.0f, .ior = ior, .flags = flags});
    }
    const std::vector<Config> configs = from_all_sides(materials);
    const auto all = drawn(gpu::kLobeMultiple, configs, {.glass_ior = ior});
    for (std::size_t i = 0; i < configs.size(); ++i) {
      const std::string what =
          fmt::format("alpha {} ior {} flags {} cos {}", configs[i].alpha, ior, configs[i].flags, configs[i].wo.z);
      EXPECT_GE(all[i].weight.y, 0.99) << what;
      EXPECT_LE(all[i].weight.y, 1.002 + 3.0 * all[i].weight_error) << what;
    }
  }
}

// Without the lobe they lose what the tables say, so that the test above cannot pass by itself.
TEST_F(LayersTest, ASingleBounceLosesLight) {
  DrawSettings single;
  single.features = gpu::kFeaturesAll;
  EXPECT_LT(draw(device(), {seen_from({.metallic = 1.0f, .alpha = 1.0f}, 0.9)}, single).drawn[0].weight.y, 0.4);
}

// Multiple bounces between coloured facets deepen the colour: F0 = 0.5 keeps less than half of the light.
TEST_F(LayersTest, ColoursDeepen) {
  const glm::vec3 gold(1.0f, 0.5f, 0.1f);
  const Drawn d = drawn(gpu::kLobeMultiple, {seen_from({.base_color = gold, .metallic = 1.0f, .alpha = 1.0f}, 0.9)})[0];
  EXPECT_NEAR(d.weight.x, 1.0, 0.01);
  // 0.36 of the light bounces once, at 0.52 on average; 0.64 is left, of which metal_returns() gives 0.163.
  EXPECT_NEAR(d.weight.y, 0.36 * 0.52 + 0.64 * 0.163, 0.02);
  EXPECT_LT(d.weight.z / d.weight.y, 0.25);
}

TEST_F(LayersTest, AreReciprocal) {
  std::vector<Config> configs;
  for (const Config& c : zoo()) {
    if (c.coat_normal.z < 1.0f) continue; // two normals: f |cos| goes by that of the coat
    configs.push_back(c);
    configs.push_back(c);
    configs.back().flags ^= kEntering;
  }
  std::vector<Pair> there, back;
  std::uint64_t state = 7;
  const auto next = [&] {
    return double((state = state * 6364136223846793005u + 1442695040888963407u) >> 40) * 0x1p-24;
  };
  for (std::uint32_t c = 0; c < configs.size(); ++c)
    for (int i = 0; i < 200; ++i) {
      const glm::vec3 o(direction(0.05 + 0.95 * next(), 6.28 * next())),
          w(direction((next() < 0.5 ? -1.0 : 1.0) * (0.05 + 0.95 * next()), 6.28 * next()));
      there.push_back({o, c, glm::vec4(w, 0.0f)});
      const bool through = w.z < 0.0f;
      const glm::vec3 flip(1.0f, 1.0f, through ? -1.0f : 1.0f);
      back.push_back({w * flip, through ? c ^ 1u : c, glm::vec4(o * flip, 0.0f)});
    }
  const auto f = evaluate(device(), configs, there, gpu::kHemisphereCosine, kAll);
  const auto g = evaluate(device(), configs, back, gpu::kHemisphereCosine, kAll);
  int through_count = 0;
  for (std::size_t i = 0; i < f.size(); ++i) {
    const Config& c = configs[there[i].config];
    const bool through = there[i].wi.z < 0.0f, thin = (c.flags & kThin) != 0, entering = (c.flags & kEntering) != 0;
    if (through && c.diffuse_transmission > 0.0f && !thin) continue;
    const double outside = through && !thin ? double(c.ior) * c.ior : 1.0;
    const double ratio = entering ? 1.0 / outside : outside;
    for (int k = 0; k < 3; ++k) {
      const double a = f[i][k] / std::abs(there[i].wi.z), b = ratio * g[i][k] / std::abs(back[i].wi.z);
      through_count += through && a > 0.0;
      ASSERT_NEAR(a, b, 2e-3 * std::max(a, b) + 1e-6)
          << "config " << there[i].config << " alpha " << c.alpha << " flags " << c.flags << " from " << there[i].wo.z
          << " to " << there[i].wi.z;
    }
  }
  EXPECT_GT(through_count, 100);
}

// A smooth coat of ior 1.5 above black reflects 4 % at normal incidence.
TEST_F(LayersTest, ACoatReflectsAsFresnelSays) {
  const Config black{.base_color = glm::vec3(0.0f), .specular = 0.0f, .coat = 0.5f};
  const auto all = drawn(gpu::kLobeCoat, {seen_from(black, 1.0), seen_from(black, 0.5)}, {.batches = 4});
  EXPECT_NEAR(all[0].weight.x, 0.5 * 0.04, 1e-4);
  EXPECT_EQ(all[0].delta, 1.0);
  const double c = 0.5, g = std::sqrt(c * c + 1.25), s = (g - c) / (g + c),
               p = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
  EXPECT_NEAR(all[1].weight.x, 0.5 * 0.5 * s * s * (1.0 + p * p), 1e-4);
}

// Below a white coat of any roughness, a white diffuse base returns nearly all light.
TEST_F(LayersTest, WhiteUnderACoatReturnsNearlyAll) {
  std::vector<Config> materials;
  for (const float alpha : {0.0f, 0.1f, 0.5f})
    materials.push_back({.specular = 0.0f, .coat = 1.0f, .coat_alpha = alpha});
  for (const Drawn& d : drawn(gpu::kLobeCoat, from_all_sides(materials))) EXPECT_GE(d.weight.y, 0.93);
}

// Sheen shines at the rim; the table holds its albedo.
TEST_F(LayersTest, SheenIsBrightestAtTheRim) {
  const Config cloth{
      .base_color = glm::vec3(0.0f), .specular = 0.0f, .sheen_color = glm::vec3(1.0f), .sheen_roughness = 0.5f};
  const auto all =
      drawn(gpu::kLobeSheen, {seen_from(cloth, 1.0), seen_from(cloth, 0.05), seen_from(cloth, 0.25)}, {.batches = 256});
  EXPECT_GT(all[1].weight.y, 4.0 * all[0].weight.y);
  // A node: cosine 0.25 = (16 / 32)^2, roughness 0.5 = 16 / 32.
  EXPECT_NEAR(all[2].weight.y, sheen_albedo_table()[16 * gpu::kTableCells + 16].x, 5e-3);
}

// A film thicker than the coherence of daylight shows the plain sum of all reflections, one of no thickness none.
TEST_F(LayersTest, FilmsHaveTheirLimits) {
  const double cosines[] = {1.0, 0.6, 0.3};
  std::vector<Config> configs;
  for (const float nanometres : {5e4f, 1e-6f, 400.0f})
    for (const double cosine : cosines)
      configs.push_back(seen_from({.base_color = glm::vec3(0.3f),
                                   .metallic = 1.0f,
                                   .alpha = 0.0f,
                                   .film = 1.0f,
                                   .film_ior = 1.5f,
                                   .film_nanometres = nanometres},
                                  cosine));
  const auto all = drawn(gpu::kLobeIridescence, configs, {.batches = 8});
  const auto schlick = [](double f0, double c) { return f0 + (1.0 - f0) * std::pow(1.0 - c, 5.0); };
  const auto exact = [](double c, double eta) {
    const double g = std::sqrt(c * c + eta * eta - 1.0), s = (g - c) / (g + c);
    const double p = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    return 0.5 * s * s * (1.0 + p * p);
  };
  const double root = std::sqrt(0.3), base_ior = (1.0 + root) / (1.0 - root);
  const double step = (base_ior - 1.5) / (base_ior + 1.5);
  for (std::size_t i = 0; i < 3; ++i) {
    const double cosine = cosines[i], inside = std::sqrt(1.0 - (1.0 - cosine * cosine) / 2.25);
    const double above = exact(cosine, 1.5), below = schlick(step * step, inside);
    const double sum = above + (1.0 - above) * (1.0 - above) * below / (1.0 - above * below);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(all[i].weight[k], sum, 2e-3) << cosine;
      EXPECT_NEAR(all[i + 3].weight[k], schlick(0.3, cosine), 2e-2) << cosine;
    }
  }
  const glm::dvec3 coloured = all[6].weight; // a path difference of two wavelengths of some colours
  EXPECT_GT(std::max({coloured.x, coloured.y, coloured.z}) - std::min({coloured.x, coloured.y, coloured.z}), 0.05);
}

// Diffuse transmission splits the base: its fraction goes through, coloured.
TEST_F(LayersTest, DiffuseTransmissionSplitsTheBase) {
  const Config leaf{.base_color = {0.8f, 0.8f, 0.8f},
                    .specular = 0.0f,
                    .diffuse_through = {0.5f, 0.25f, 1.0f},
                    .diffuse_transmission = 0.25f};
  const Drawn d = drawn(gpu::kLobeDiffuseTransmission, {seen_from(leaf, 0.6)}, {.batches = 256})[0];
  EXPECT_NEAR(d.weight.x, 0.75 * 0.8 + 0.25 * 0.5, 2e-3);
  EXPECT_NEAR(d.weight.y, 0.75 * 0.8 + 0.25 * 0.25, 2e-3);
  EXPECT_NEAR(d.weight.z, 0.75 * 0.8 + 0.25 * 1.0, 2e-3);
  EXPECT_GT(d.transmitted, 0.05);
}

// Equal stretches are the round lobe; the stretched one is reciprocal and normalized (chi-square tests its density).
TEST_F(LayersTest, EqualStretchIsRound) {
  std::vector<Config> configs{seen_from({.metallic = 1.0f, .alpha = 0.3f}, 0.6),
                              seen_from({.metallic = 1.0f, .alpha = 0.3f, .stretched_alpha = {0.3f, 0.300001f}}, 0.6)};
  std::vector<Pair> pairs;
  for (std::uint32_t c = 0; c < 2; ++c)
    for (int k = 1; k < 20; ++k) pairs.push_back({glm::vec3(configs[c].wo), c, direction(k / 20.0, 0.3 * k)});
  const auto values =
      evaluate(device(), configs, pairs, gpu::kHemisphereCosine, gpu::kFeatureSpecular | gpu::kLobeAnisotropy);
  for (std::size_t i = 0; i < pairs.size() / 2; ++i)
    EXPECT_NEAR(values[i].x, values[i + pairs.size() / 2].x, 1e-4 * values[i].x);
}

// Kernels that have lobes give the bits of those that have none, for materials without them.
TEST_F(LayersTest, LeavingLobesOutChangesNoBit) {
  const gpu::Feature lobes = gpu::kLobesAll & ~gpu::kLobeMultiple; // which changes rough metal, as it should
  const auto configs = from_all_sides({{.specular = 0.0f},
                                       {.alpha = 0.3f},
                                       {.base_color = {1.0f, 0.7f, 0.3f}, .metallic = 1.0f, .alpha = 0.3f},
                                       {.alpha = 0.2f, .transmission = 1.0f, .flags = kEntering},
                                       {.alpha = 0.0f, .transmission = 0.5f}});
  DrawSettings with{.batches = 4, .bins = 8}, without = with;
  with.features = gpu::kFeaturesAll | lobes;
  without.features = gpu::kFeaturesAll;
  const auto a = draw(device(), configs, with), b = draw(device(), configs, without);
  EXPECT_EQ(a.raw, b.raw);
  EXPECT_EQ(a.histogram, b.histogram);
}

// The tables against quadrature made elsewhere (tests/bsdf_test.cpp, GgxFurnaceFollowsTheTable), and exact ends.
TEST(AlbedoTables, MatchKnownValues) {
  const std::vector<glm::vec4> table = ggx_albedo_table();
  ASSERT_EQ(table.size(), gpu::kTableTexels);
  EXPECT_NEAR(table[31 * gpu::kTableCells + 31].w, 1.0 - std::log(2.0), 2e-3); // alpha 1, along the normal
  EXPECT_NEAR(table.back().x, 1.0 - 0.409, 3e-3);                              // its mean
  EXPECT_EQ(table[0].x, 1.0f);                                                 // a mirror
  const std::vector<glm::vec4> glass = glass_albedo_tables(1.5);
  ASSERT_EQ(glass.size(), 2 * gpu::kTableTexels);
  EXPECT_NEAR(glass[gpu::kTableCells * gpu::kTableCells].z, 1.0 - 0.0918, 5e-4); // Walsh: mean reflectance at ior 1.5
}

} // namespace
} // namespace wavepath::test
