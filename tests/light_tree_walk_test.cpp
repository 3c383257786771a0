// kernels/light/light_tree.glsl on the device: picks follow their probabilities, probabilities make one, and no light
// that shines on a point is left out.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "host/scene/pack/light_tree.h"
#include "tests/light_set.h"
#include "tests/probe.h"
#include "tests/statistics.h"

#include "tests/probes/light_tree_probe.spv.h"

namespace wavepath::test {
namespace {

struct Element {
  glm::vec3 position{0.0f};
  std::uint32_t bits = 0;
  glm::vec3 normal{0.0f};
  std::uint32_t branches = 0;
  std::uint32_t light = 0;
  float probability = 0.0f, below_cluster = 0.0f, remainder = 0.0f, asked = 0.0f, asked_below_cluster = 0.0f;
  std::uint32_t in_cluster = 0, pad0 = 0;
};
static_assert(sizeof(Element) == 64);

class LightTreeWalk : public VulkanTest {
protected:
  std::vector<Element> run(const LightTree& tree, const std::vector<Element>& elements) {
    const Buffer records = upload(device(), tree.records), in_out = upload(device(), elements);
    const std::vector<Binding> bindings{{0, BindingKind::texels_rgba32ui, &records},
                                        {1, BindingKind::storage, &in_out}};
    const auto count = static_cast<std::uint32_t>(elements.size());
    const BindingSet set(device(), bindings, sizeof count);
    const Kernel kernel(device(), "light_tree_probe", wavepath_light_tree_probe_spv, set, {});
    Commands commands(device());
    commands.bind(set);
    commands.dispatch(kernel, groups_for(count), &count);
    commands.submit_and_wait();
    return download<Element>(in_out, elements.size());
  }

  // The probability of every light at one receiver.
  std::vector<Element> ask_all(const LightTree& tree, const glm::vec3& position, const glm::vec3& normal) {
    std::vector<Element> ask;
    for (const std::uint32_t branches : tree.branches)
      ask.push_back({.position = position, .normal = normal, .branches = branches});
    return run(tree, ask);
  }
  std::vector<float> probabilities(const LightTree& tree, const glm::vec3& position, const glm::vec3& normal) {
    std::vector<float> result;
    for (const Element& e : ask_all(tree, position, normal)) result.push_back(e.asked);
    return result;
  }
};

const std::vector<std::pair<glm::vec3, glm::vec3>> kReceivers = {{{10, 5, 0}, {0, 0, 1}},
                                                                 {{10, 5, 2.5}, {0, 0, 0}},
                                                                 {{-5, 5, 2}, {1, 0, 0}},
                                                                 {{3, 9, 4}, {0.6f, -0.8f, 0}},
                                                                 {{200, -300, 50}, {0, 0, 0}}};

TEST_F(LightTreeWalk, PicksFollowTheirProbabilities) {
  const std::vector<LightBounds> lights = mixed_lights(500, 11);
  const LightTree tree = build_light_tree(lights);
  constexpr std::uint32_t kPicks = 1u << 18;
  for (const auto& [position, normal] : kReceivers) {
    const std::vector<float> probability = probabilities(tree, position, normal);
    std::vector<Element> picks(kPicks);
    std::mt19937 random(1);
    for (std::uint32_t i = 0; i < kPicks; ++i)
      picks[i] = {.position = position, .bits = static_cast<std::uint32_t>(random()), .normal = normal};
    std::vector<double> counts(lights.size() + 1), expected;
    std::vector<double> rest(64);
    double live = 0.0, picked = 0.0;
    for (const Element& e : run(tree, picks)) {
      if (e.light == gpu::kNone) {
        counts.back() += 1.0;
        continue;
      }
      counts[e.light] += 1.0;
      picked += 1.0;
      ASSERT_EQ(e.probability, probability[e.light]); // bit by bit: the weights of both techniques make one
      ASSERT_TRUE(e.remainder >= 0.0f && e.remainder < 1.0f);
      rest[static_cast<std::size_t>(e.remainder * 64.0f)] += 1.0;
    }
    for (const float p : probability) {
      expected.push_back(double(p) * kPicks);
      live += p;
    }
    EXPECT_LE(live, 1.0 + 1e-6);
    expected.push_back((1.0 - live) * kPicks);
    EXPECT_GT(chi_square(counts, expected).p_value, 1e-3);
    EXPECT_GT(chi_square_uniform(rest).p_value, 1e-3);
    EXPECT_GT(picked, 0.9 * kPicks) << "dead ends";
  }
}

// Below one cluster, as trained selection draws.
TEST_F(LightTreeWalk, PicksBelowAClusterFollowTheirProbabilities) {
  const std::vector<LightBounds> lights = mixed_lights(2000, 5);
  const LightTree tree = build_light_tree(lights);
  const auto [position, normal] = kReceivers[1];
  const std::vector<Element> asked = ask_all(tree, position, normal);
  for (const std::uint32_t cluster : {0u, 30u, 60u}) {
    constexpr std::uint32_t kPicks = 1u << 16;
    std::vector<Element> picks(kPicks);
    for (std::uint32_t i = 0; i < kPicks; ++i)
      picks[i] = {.position = position,
                  .bits = (i << 16) + 0x8000u,
                  .normal = normal,
                  .branches = tree.cluster_branches[cluster],
                  .in_cluster = 1};
    std::vector<double> counts(lights.size());
    for (const Element& e : run(tree, picks)) {
      if (e.light == gpu::kNone) continue;
      ASSERT_EQ(tree.clusters[e.light], cluster);
      ASSERT_EQ(e.probability, asked[e.light].asked);
      ASSERT_EQ(e.below_cluster, asked[e.light].asked_below_cluster);
      counts[e.light] += 1.0;
    }
    for (std::size_t i = 0; i < lights.size(); ++i) {
      if (tree.clusters[i] == cluster) {
        EXPECT_NEAR(counts[i], asked[i].asked_below_cluster * double(kPicks), 1.5);
      }
    }
  }
}

TEST_F(LightTreeWalk, ProbabilitiesMakeOneWhereNothingIsDark) {
  std::vector<LightBounds> lights;
  for (const LightBounds& light : mixed_lights(3000, 2))
    lights.push_back(point_light_bounds(light.lo, light.intensity)); // shine everywhere
  const LightTree tree = build_light_tree(lights);
  for (const auto& [position, normal] : kReceivers) {
    double sum = 0.0;
    for (const float p : probabilities(tree, position, glm::vec3(0.0f))) {
      EXPECT_GT(p, 0.0f);
      sum += p;
    }
    EXPECT_NEAR(sum, 1.0, 1e-5);
  }
}

// A net over the integers becomes a net over each light: its fraction of them is exact, and what is left is even.
TEST_F(LightTreeWalk, KeepsTheNetOfTheSampler) {
  const std::vector<LightBounds> lights = mixed_lights(16, 4);
  const LightTree tree = build_light_tree(lights);
  constexpr std::uint32_t kPicks = 1u << 16;
  std::vector<Element> picks(kPicks);
  for (std::uint32_t i = 0; i < kPicks; ++i)
    picks[i] = {.position = {10, 5, -2}, .bits = (i << 16) + 0x8000u, .normal = {0, 0, 0}};
  const std::vector<float> probability = probabilities(tree, picks[0].position, picks[0].normal);
  std::vector<double> counts(lights.size());
  std::vector<std::vector<float>> rest(lights.size());
  for (const Element& e : run(tree, picks)) {
    if (e.light == gpu::kNone) continue;
    counts[e.light] += 1.0;
    rest[e.light].push_back(e.remainder);
  }
  for (std::size_t i = 0; i < lights.size(); ++i) {
    EXPECT_NEAR(counts[i], probability[i] * double(kPicks), 1.0) << i;
    std::sort(rest[i].begin(), rest[i].end());
    const double n = double(rest[i].size());
    for (std::size_t k = 0; k < rest[i].size(); ++k) EXPECT_NEAR(rest[i][k], (double(k) + 0.5) / n, 1.5 / n);
  }
}

// What a light really brings to a point, against the bound.
TEST_F(LightTreeWalk, LeavesNoLightOut) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  std::normal_distribution<float> gauss;
  for (const float scale : {1.0f, 1e-4f, 1e4f}) {
    std::vector<LightBounds> lights = mixed_lights(200, 21);
    std::vector<glm::vec3> corner[3];
    for (LightBounds& light : lights) light.lo *= scale, light.hi *= scale;
    const LightTree tree = build_light_tree(lights);
    std::vector<Element> ask;
    for (int point = 0; point < 400; ++point) {
      const glm::vec3 position =
          scale * glm::vec3(24.0f * unit(random) - 2.0f, 12.0f * unit(random), 6.0f * unit(random));
      const glm::vec3 normal = glm::normalize(glm::vec3(gauss(random), gauss(random), gauss(random)));
      for (std::size_t i = 0; i < lights.size(); ++i)
        ask.push_back(
            {.position = position, .normal = normal, .branches = tree.branches[i], .light = std::uint32_t(i)});
    }
    const std::vector<Element> answers = run(tree, ask);
    int lit = 0;
    for (std::size_t k = 0; k < ask.size(); ++k) {
      const LightBounds& light = lights[ask[k].light];
      bool reaches = false; // from some point of its box
      for (int c = 0; c < 9 && !reaches; ++c) {
        const glm::dvec3 t = c == 8 ? glm::dvec3(0.5) : glm::dvec3(c & 1, c >> 1 & 1, c >> 2 & 1);
        const glm::dvec3 from = glm::mix(glm::dvec3(light.lo), glm::dvec3(light.hi), t);
        const glm::dvec3 to_light = glm::normalize(from - glm::dvec3(ask[k].position));
        double leaving = -glm::dot(to_light, glm::dvec3(light.axis));
        if (light.two_sided) leaving = std::abs(leaving);
        const double angle = std::acos(std::clamp(leaving, -1.0, 1.0));
        reaches = glm::dot(to_light, glm::dvec3(ask[k].normal)) > 0.0 && angle < light.theta_o + light.theta_e;
      }
      if (!reaches) continue;
      ++lit;
      ASSERT_GT(answers[k].asked, 0.0f) << "light " << ask[k].light << " at scale " << scale;
    }
    EXPECT_GT(lit, 10000);
  }
}

// A million picks a light would hit it: what is weak still has its fraction.
TEST_F(LightTreeWalk, ReachesLightsBelowTheResolutionOfOneInteger) {
  std::vector<LightBounds> lights;
  for (int i = 0; i < 60; ++i)
    lights.push_back(point_light_bounds({static_cast<float>(i), 0, 0}, std::exp2(-static_cast<double>(i))));
  const LightTree tree = build_light_tree(lights);
  double sum = 0.0;
  for (const float p : probabilities(tree, {-10, 0, 0}, {0, 0, 0})) {
    EXPECT_GT(p, 0.0f);
    sum += p;
  }
  EXPECT_NEAR(sum, 1.0, 1e-5);
}

} // namespace
} // namespace wavepath::test
