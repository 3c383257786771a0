// The BSDF on the device: energy, furnaces, reciprocity, limits, and that leaving features out changes no bit.
#include "tests/bsdf_probe.h"

namespace wavepath::test {
namespace {

constexpr double kCosines[] = {1.0, 0.9, 0.7, 0.5, 0.2, 0.05, 1e-2, 1e-3};

Config lambert(const glm::vec3& color = glm::vec3(1.0f)) { return {.base_color = color, .specular = 0.0f}; }
Config metal(float alpha, const glm::vec3& color = glm::vec3(1.0f)) {
  return {.base_color = color, .metallic = 1.0f, .alpha = alpha};
}
Config coat(float alpha, float ior = 1.5f) { return {.alpha = alpha, .ior = ior}; }
Config glass(float alpha, float ior, std::uint32_t flags) {
  return {.alpha = alpha, .transmission = 1.0f, .ior = ior, .flags = flags};
}
Config seen_from(Config config, double cosine) {
  config.wo = direction(cosine);
  return config;
}
// Everything at once; white, so that its albedo must not exceed 1.
Config mixture(std::uint32_t flags) {
  return {.metallic = 0.3f,
          .specular_color = {0.2f, 1.0f, 3.0f},
          .specular = 0.8f,
          .alpha = 0.3f,
          .transmission = 0.6f,
          .ior = 1.7f,
          .flags = flags};
}

std::vector<Config> zoo() {
  std::vector<Config> configs{lambert(), coat(0.0f), coat(1.0f, 0.0f), glass(0.3f, 0.0f, kThin)};
  for (const float alpha : {0.01f, 0.1f, 0.3f, 1.0f}) {
    configs.push_back(metal(alpha));
    for (const float ior : {1.0f, 1.5f, 2.4f, 10.0f}) {
      configs.push_back(coat(alpha, ior));
      for (const std::uint32_t flags : {kEntering, 0u, kThin}) configs.push_back(glass(alpha, ior, flags));
    }
  }
  for (const std::uint32_t flags : {kEntering, 0u, kThin}) configs.push_back(mixture(flags));
  return configs;
}

std::vector<Config> from_all_sides(const std::vector<Config>& materials) {
  std::vector<Config> configs;
  for (const Config& material : materials)
    for (const double cosine : kCosines) configs.push_back(seen_from(material, cosine));
  return configs;
}

std::string describe(const Config& c) {
  return "metallic " + std::to_string(c.metallic) + " specular " + std::to_string(c.specular) + " alpha " +
         std::to_string(c.alpha) + " transmission " + std::to_string(c.transmission) + " ior " + std::to_string(c.ior) +
         " flags " + std::to_string(c.flags) + " cos " + std::to_string(c.wo.z);
}

double fresnel(double c, double eta) { // textbook form, in double
  const double t2 = 1.0 - (1.0 - c * c) / (eta * eta);
  if (t2 <= 0.0) return 1.0;
  const double t = std::sqrt(t2), s = (c - eta * t) / (c + eta * t), p = (eta * c - t) / (eta * c + t);
  return 0.5 * (s * s + p * p);
}

class BsdfTest : public VulkanTest {
protected:
  std::vector<Drawn> drawn(const std::vector<Config>& configs, const DrawSettings& settings = {}) {
    return draw(device(), configs, settings).drawn;
  }
};

TEST_F(BsdfTest, SamplesAreSoundAgreeWithEvalAndKeepEnergy) {
  const std::vector<Config> configs = from_all_sides(zoo());
  for (const std::uint32_t hemisphere : {gpu::kHemisphereCosine, gpu::kHemisphereUniform}) {
    const auto all = drawn(configs, {.batches = 32, .hemisphere = hemisphere});
    for (std::size_t i = 0; i < configs.size(); ++i) {
      const Drawn& d = all[i];
      EXPECT_EQ(d.bad, 0.0) << describe(configs[i]);
      EXPECT_LT(d.mismatch, 1e-4) << describe(configs[i]);
      if (configs[i].ior > 3.0f && configs[i].transmission == 0.0f)
        continue; // see WhiteUnderARoughCoatReturnsNearlyAll
      EXPECT_LE(std::max({d.weight.x, d.weight.y, d.weight.z}), 1.001 + 3.0 * d.weight_error) << describe(configs[i]);
    }
  }
}

TEST_F(BsdfTest, LambertFurnaceIsExact) {
  for (const Drawn& d : drawn(from_all_sides({lambert(), {.specular = 1.0f, .ior = 1.0f}}))) {
    EXPECT_EQ(d.least, 1.0);
    EXPECT_EQ(d.most, 1.0);
    EXPECT_EQ(d.rejected, 0.0);
    EXPECT_NEAR(d.weight.x, 1.0, 1e-6);
  }
  const Drawn tinted = drawn({seen_from(lambert({0.8f, 0.5f, 0.2f}), 0.3)})[0];
  EXPECT_EQ(tinted.most, double(0.8f));
  EXPECT_EQ(tinted.least, double(0.2f));
  EXPECT_NEAR(tinted.weight.y, 0.5, 1e-5);
  const Drawn uniform = drawn({lambert()}, {.hemisphere = gpu::kHemisphereUniform})[0];
  EXPECT_NEAR(uniform.weight.x, 1.0, 1e-4);
  EXPECT_LE(uniform.most, 2.0);
}

// Single-scatter albedo of GGX with height-correlated Smith shadowing and F = 1, by quadrature elsewhere; alpha = 1
// seen along the normal is exactly 1 - ln 2.
TEST_F(BsdfTest, GgxFurnaceFollowsTheTable) {
  const float alphas[] = {0.1f, 0.25f, 0.5f, 0.75f, 1.0f};
  const double cosines[] = {1.0, 0.7, 0.5, 0.2, 0.05};
  const double table[5][5] = {{.987, .982, .969, .905, .912},
                              {.916, .885, .857, .848, .933},
                              {.688, .683, .698, .790, .913},
                              {.464, .512, .565, .716, .881},
                              {.30685, .379, .451, .642, .848}};
  const double averages[] = {.971, .882, .700, .536, .409};
  for (std::size_t a = 0; a < 5; ++a) {
    std::vector<Config> configs;
    for (const double cosine : cosines) configs.push_back(seen_from(metal(alphas[a]), cosine));
    constexpr int kCells = 16; // of cos^2, for the cosine-weighted average
    for (int i = 0; i < kCells; ++i) configs.push_back(seen_from(metal(alphas[a]), std::sqrt((i + 0.5) / kCells)));
    const auto all = drawn(configs);
    double average = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i < 5) {
        EXPECT_NEAR(all[i].weight.x, table[a][i], 2e-3) << "alpha " << alphas[a] << " cos " << cosines[i];
      } else {
        average += all[i].weight.x / kCells;
      }
      EXPECT_LE(all[i].most, 1.001); // G2 / G1
    }
    EXPECT_NEAR(average, averages[a], 2e-3) << "alpha " << alphas[a];
  }
  EXPECT_NEAR(drawn({metal(1.0f)}, {.batches = 1024})[0].weight.x, 1.0 - std::log(2.0), 2e-4);
}

// Smooth glass loses no light: every single sample has weight 1.
TEST_F(BsdfTest, DielectricFurnaceIsExact) {
  std::vector<Config> materials;
  for (const float ior : {1.0f, 1.0f + 1e-6f, 1.5f, 10.0f})
    for (const float alpha : {0.0f, 1e-5f})
      for (const std::uint32_t flags : {kEntering, 0u, kThin}) materials.push_back(glass(alpha, ior, flags));
  const auto configs = from_all_sides(materials);
  const auto all = drawn(configs, {.batches = 8});
  for (std::size_t i = 0; i < configs.size(); ++i) {
    EXPECT_EQ(all[i].rejected, 0.0) << describe(configs[i]);
    EXPECT_EQ(all[i].delta, 1.0) << describe(configs[i]);
    EXPECT_NEAR(all[i].least, 1.0, 1e-5) << describe(configs[i]);
    EXPECT_NEAR(all[i].most, 1.0, 1e-5) << describe(configs[i]);
  }
}

TEST_F(BsdfTest, SmoothGlassReflectsAsFresnelSays) {
  std::vector<Config> configs =
      from_all_sides({glass(0.0f, 1.5f, kEntering), glass(0.0f, 1.5f, 0), glass(0.0f, 2.4f, kThin)});
  const auto all = drawn(configs, {.batches = 256});
  for (std::size_t i = 0; i < configs.size(); ++i) {
    const double eta = configs[i].flags == 0 ? 1.0 / 1.5 : double(configs[i].ior);
    EXPECT_NEAR(1.0 - all[i].transmitted, fresnel(configs[i].wo.z, eta), 1e-4) << describe(configs[i]);
  }
}

// The Fresnel fraction is reflected as it is; the base colour tints the rest.
TEST_F(BsdfTest, TheBaseColorTintsWhatGlassTransmits) {
  const glm::vec3 tint(0.9f, 0.5f, 0.1f);
  std::vector<Config> smooth, rough;
  for (const std::uint32_t flags : {kEntering, 0u, kThin}) {
    smooth.push_back(glass(0.0f, 1.5f, flags));
    rough.push_back(glass(0.3f, 1.5f, flags));
    rough.push_back(rough.back());
    smooth.back().base_color = rough.back().base_color = tint; // rough: white, then tinted
  }
  const auto configs = from_all_sides(smooth);
  const auto all = drawn(configs, {.batches = 256});
  for (std::size_t i = 0; i < configs.size(); ++i) {
    const double reflected = fresnel(configs[i].wo.z, configs[i].flags == 0 ? 1.0 / 1.5 : 1.5);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(all[i].weight[k], reflected + tint[k] * (1.0 - reflected), 5e-4) << describe(configs[i]);
  }
  std::vector<Pair> pairs;
  for (std::uint32_t i = 0; i < rough.size(); ++i)
    pairs.push_back({glm::vec3(direction(0.9)), i, glm::vec4(-glm::vec3(direction(0.9)), 0.0f)});
  const auto values = evaluate(device(), rough, pairs);
  for (std::size_t i = 0; i < rough.size(); i += 2) {
    EXPECT_GT(values[i].x, 0.0f) << describe(rough[i]);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(values[i + 1][k] / values[i][k], tint[k], 1e-5) << describe(rough[i]);
  }
}

TEST_F(BsdfTest, TotalReflectionStartsAtTheCriticalAngle) {
  const double degree = std::numbers::pi / 180.0;
  for (const float alpha : {0.0f, 0.2f}) {
    const auto below = drawn({seen_from(glass(alpha, 1.5f, 0), std::cos(41.80 * degree))})[0];
    const auto above = drawn({seen_from(glass(alpha, 1.5f, 0), std::cos(41.82 * degree))})[0];
    EXPECT_GT(below.transmitted, 0.0);
    EXPECT_EQ(below.bad + above.bad, 0.0);
    if (alpha == 0.0f) {
      EXPECT_EQ(above.transmitted, 0.0);
      EXPECT_EQ(above.rejected, 0.0);
    }
  }
}

// Diffuse Fresnel reflectance, outside and inside: the means over cosine-weighted directions.
TEST_F(BsdfTest, MeanReflectanceMatchesTheKnownIntegrals) {
  const struct {
    float ior;
    double outside, inside;
  } known[] = {{1.33f, .065931, .471949}, {1.5f, .091778, .596346}, {2.4f, .210181, .862879}};
  for (const auto& k : known) {
    constexpr int kCells = 128; // of cos^2
    std::vector<Config> configs;
    for (const std::uint32_t flags : {kEntering, 0u})
      for (int i = 0; i < kCells; ++i)
        configs.push_back(seen_from(glass(0.0f, k.ior, flags), std::sqrt((i + 0.5) / kCells)));
    const auto all = drawn(configs, {.batches = 16});
    double sums[2] = {};
    for (std::size_t i = 0; i < all.size(); ++i) sums[i / kCells] += (1.0 - all[i].transmitted) / kCells;
    EXPECT_NEAR(sums[0], k.outside, 1e-3) << k.ior;
    EXPECT_NEAR(sums[1], k.inside, 1e-3) << k.ior;
  }
}

// What a smooth coat lets in and out again, over a white base, is everything: the coupling of base and interface is
// exact but for the fit to the mean reflectance.
TEST_F(BsdfTest, SmoothCoatOverWhiteReturnsEverything) {
  std::vector<Config> materials;
  for (const float ior : {1.1f, 1.33f, 1.5f, 1.8f, 2.4f, 4.0f, 10.0f}) materials.push_back(coat(0.0f, ior));
  materials.push_back({.specular_color = glm::vec3(2.0f), .specular = 0.5f, .alpha = 0.0f});
  const auto configs = from_all_sides(materials);
  const auto all = drawn(configs, {.batches = 512});
  for (std::size_t i = 0; i < configs.size(); ++i) EXPECT_NEAR(all[i].weight.y, 1.0, 6e-4) << describe(configs[i]);
}

TEST_F(BsdfTest, WhiteUnderARoughCoatReturnsNearlyAll) {
  std::vector<Config> materials, extreme;
  for (const float alpha : {0.02f, 0.1f, 0.3f, 0.6f, 1.0f}) {
    for (const float ior : {1.1f, 1.33f, 1.5f, 1.8f}) materials.push_back(coat(alpha, ior));
    for (int i = 0; i < 32; ++i) extreme.push_back(seen_from(coat(alpha, 10.0f), std::sqrt((i + 0.5) / 32.0)));
  }
  const auto configs = from_all_sides(materials);
  const auto all = drawn(configs, {.batches = 128});
  for (std::size_t i = 0; i < configs.size(); ++i) {
    EXPECT_LT(all[i].weight.x, 1.001 + 3.0 * all[i].weight_error) << describe(configs[i]);
    EXPECT_GT(all[i].weight.x, configs[i].ior < 1.2f ? 0.88 : 0.93) << describe(configs[i]);
  }
  const auto of_extreme = drawn(extreme);
  for (std::size_t first = 0; first < extreme.size(); first += 32) { // cosine-weighted mean
    double mean = 0.0;
    for (std::size_t i = first; i < first + 32; ++i) mean += of_extreme[i].weight.x / 32.0;
    EXPECT_LT(mean, 1.001) << describe(extreme[first]);
  }
}

TEST_F(BsdfTest, RoughnessGoesToZeroAsAMirror) {
  const Drawn mirror = drawn({seen_from(metal(0.0f), 0.7)})[0];
  EXPECT_EQ(mirror.delta, 1.0);
  EXPECT_EQ(mirror.weight.x, 1.0);
  EXPECT_LT(mirror.farthest, 1e-6);
  for (const float alpha : {0.0f, 1e-8f, 1e-4f, 1e-3f}) {
    for (const Config& config : {metal(alpha), coat(alpha), glass(alpha, 1.5f, kEntering), glass(alpha, 1.5f, 0)}) {
      const Drawn d = drawn({seen_from(config, 0.9)}, {.batches = 16})[0];
      EXPECT_EQ(d.bad, 0.0) << describe(config);
      EXPECT_NEAR(d.weight.x, 1.0, 1e-3) << describe(config);
      EXPECT_EQ(d.delta > 0.0, alpha < 1e-4f) << describe(config);
    }
  }
}

TEST_F(BsdfTest, GrazingStaysFinite) {
  std::vector<Config> configs;
  for (const Config& material : zoo())
    for (const double cosine : {1e-3, 1e-5, 1e-7, 1e-12}) configs.push_back(seen_from(material, cosine));
  for (const float alpha : {0.0f, 1e-4f, 1e-3f})
    for (const double cosine : {1e-3, 1e-5, 1e-7, 1e-12}) {
      configs.push_back(seen_from(metal(alpha), cosine));
      configs.push_back(seen_from(coat(alpha), cosine));
      for (const std::uint32_t flags : {kEntering, 0u, kThin})
        configs.push_back(seen_from(glass(alpha, 1.5f, flags), cosine));
    }
  const auto all = drawn(configs, {.batches = 8});
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < configs.size(); ++i) {
    EXPECT_EQ(all[i].bad, 0.0) << describe(configs[i]);
    const bool one_lobe = configs[i].metallic == 1.0f || configs[i].transmission == 1.0f || configs[i].specular == 0.0f;
    EXPECT_LE(all[i].most, one_lobe ? 1.001 : 1e3) << describe(configs[i]);
    for (const double cosine : {1.0, 0.1, 1e-3, 1e-7, -1e-7, -1e-3, -0.1, -1.0, 0.0})
      pairs.push_back({glm::vec3(configs[i].wo), std::uint32_t(i), direction(cosine, 3.9)});
  }
  const auto values = evaluate(device(), configs, pairs);
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (int k = 0; k < 4; ++k)
      ASSERT_TRUE(std::isfinite(values[i][k]) && values[i][k] >= 0.0f)
          << describe(configs[pairs[i].config]) << " to " << pairs[i].wi.z;
  }
}

// f(wo, wi) = f(wi, wo) for reflection; across a boundary f / n^2 of the receiving side is symmetric.
TEST_F(BsdfTest, IsReciprocal) {
  std::vector<Config> configs;
  for (const Config& c :
       {lambert(), metal(0.1f, {.9f, .6f, .2f}), metal(0.5f), coat(0.2f), coat(1.0f, 2.4f), glass(0.3f, 1.5f, kThin),
        glass(0.1f, 1.5f, kEntering), glass(0.5f, 2.4f, kEntering), mixture(kThin), mixture(kEntering)}) {
    configs.push_back(c);
    configs.push_back(c);
    configs.back().flags ^= kEntering; // the same surface from the other side
  }
  std::vector<Pair> there, back;
  std::uint64_t state = 1;
  const auto next = [&] {
    return double((state = state * 6364136223846793005u + 1442695040888963407u) >> 40) * 0x1p-24;
  };
  for (std::uint32_t c = 0; c < configs.size(); ++c) {
    for (int i = 0; i < 500; ++i) {
      const glm::vec3 o(direction(0.01 + 0.99 * next(), 6.28 * next())),
          w(direction(2.0 * next() - 1.0, 6.28 * next()));
      there.push_back({o, c, glm::vec4(w, 0.0f)});
      const bool through = w.z < 0.0f; // wo of the way back must point up, so the basis is turned over
      const glm::vec3 flip(1.0f, 1.0f, through ? -1.0f : 1.0f);
      back.push_back({w * flip, through ? c ^ 1u : c, glm::vec4(o * flip, 0.0f)});
    }
  }
  const auto f = evaluate(device(), configs, there), g = evaluate(device(), configs, back);
  for (std::size_t i = 0; i < f.size(); ++i) {
    const Config& c = configs[there[i].config];
    const bool through = there[i].wi.z < 0.0f, thin = (c.flags & kThin) != 0;
    const double outside = through && !thin ? double(c.ior) * c.ior : 1.0; // f(there) = f(back) n_o^2 / n_i^2
    const double ratio = (c.flags & kEntering) ? 1.0 / outside : outside;
    // Seen from inside, the cosine outside is the root of a difference of squares that is off by some 1e-7.
    const bool entering = (c.flags & kEntering) != 0;
    const glm::vec3 h = glm::normalize(there[i].wo + glm::vec3(there[i].wi) * (entering ? c.ior : 1.0f / c.ior));
    const double root = glm::dot(entering ? there[i].wo : glm::vec3(there[i].wi), h) / c.ior;
    const double tolerance = 2e-4 + (through && !thin ? 2e-7 / (root * root) : 0.0);
    for (int k = 0; k < 3; ++k) {
      const double a = f[i][k] / std::abs(there[i].wi.z), b = ratio * g[i][k] / std::abs(back[i].wi.z);
      ASSERT_NEAR(a, b, tolerance * std::max(a, b) + 1e-7) << describe(c) << " to " << there[i].wi.z << ", pair " << i;
    }
  }
}

// Kernels without a feature give the bits of those with it, for materials that do not need it.
TEST_F(BsdfTest, LeavingFeaturesOutChangesNoBit) {
  const gpu::Feature none = gpu::kFeaturesAll & ~(gpu::kFeatureSpecular | gpu::kFeatureTransmission);
  const gpu::Feature opaque = gpu::kFeaturesAll & ~gpu::kFeatureTransmission;
  const auto same = [&](const std::vector<Config>& materials, gpu::Feature features) {
    const auto configs = from_all_sides(materials);
    for (const std::uint32_t hemisphere : {gpu::kHemisphereCosine, gpu::kHemisphereUniform}) {
      const DrawSettings all{.batches = 4, .bins = 8, .hemisphere = hemisphere};
      DrawSettings fewer = all;
      fewer.features = features;
      const auto a = draw(device(), configs, all), b = draw(device(), configs, fewer);
      EXPECT_EQ(a.raw, b.raw);
      EXPECT_EQ(a.histogram, b.histogram);
      std::vector<Pair> pairs;
      for (std::uint32_t i = 0; i < configs.size(); ++i)
        for (int k = -10; k <= 10; ++k) pairs.push_back({glm::vec3(configs[i].wo), i, direction(k / 10.0, k)});
      EXPECT_EQ(to_probe(evaluate(device(), configs, pairs, hemisphere)),
                to_probe(evaluate(device(), configs, pairs, hemisphere, features)));
    }
  };
  same({lambert(), lambert({0.8f, 0.5f, 0.2f}), lambert(glm::vec3(0.0f))}, none);
  same({lambert({0.8f, 0.5f, 0.2f}), metal(0.3f, {1.0f, 0.7f, 0.3f}), coat(0.0f), coat(0.4f)}, opaque);
}

} // namespace
} // namespace wavepath::test
