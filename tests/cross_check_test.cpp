// Integrators and sets of techniques agree with path tracing on scenes by chance (tests/body_scenes.h). The suite takes
// a few; WAVEPATH_CROSS_CHECK=FIRST:COUNT takes others, and says which disagree:
//   WAVEPATH_CROSS_CHECK=0:50 build/tests/cross_check_test
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "host/integrators/whitted/kind.h"
#include "host/render/settings/path_reuse.h"
#include "tests/body_scenes.h"

namespace wavepath::test {
namespace {

constexpr double kMostNoise = 0.03; // of the mean: parts with more of it are not judged

struct Range {
  std::uint32_t first = 0, count = 0;
};

Range asked_for() {
  Range range{4, 1};
  if (const char* text = std::getenv("WAVEPATH_CROSS_CHECK")) std::sscanf(text, "%u:%u", &range.first, &range.count);
  return range;
}

struct Way {
  std::string name;
  RenderPlan settings;
  bool is_expected = false; // those that follow are compared with it
};

class CrossCheck : public BidirectionalTest {
protected:
  static std::vector<Way> ways(const BodyScene& made, std::uint32_t depth, std::uint32_t spp) {
    std::vector<Way> all;
    RenderPlan path = path_settings(2 * spp, depth);
    path.reuse = kReuseOff;
    all.push_back({"path", path, true});
    RenderPlan guided = path;
    guided.guide = true, guided.training.guide_iterations = 2;
    all.push_back({"path --guide", guided});
    RenderPlan reuse = path;
    reuse.reuse = kReuseOn;
    all.push_back({"path --reuse", reuse});
    // Without merging, which blurs: pixels are large here.
    std::vector<std::uint32_t> sets = {kHit | kLight | kConnect | kSplat, kHit | kSplat, kHit | kConnect | kLight};
    const bool all_alone = made.punctual && !made.scene.environment.present();
    if (all_alone) sets.insert(sets.end(), {kSplat, kLight});
    for (const std::uint32_t set : sets)
      all.push_back({fmt::format("bidirectional {:05b}", set), settings(spp, depth, set)});
    for (Way& way : all) way.settings.lens.aperture = made.aperture, way.settings.lens.focus = 2.0;
    if (all_alone && !made.nested && made.aperture == 0.0) { // direct light is what it finds, too
      all.push_back({"path, once", path_settings(2 * spp, 1), true});
      RenderPlan whitted = path_settings(spp, 1);
      whitted.integrator = &kWhitted, whitted.cutoff = 0.0;
      all.push_back({"whitted, once", whitted});
    }
    return all;
  }
  // The largest difference from the first of them, in standard errors, over the picture and its parts; below 0 if none
  // of these is judged.
  double worst(const Average& a, const Average& b) {
    double worst = -1.0;
    for (std::size_t i = 0; i < kParts; ++i) {
      const double error = std::sqrt(a.variance[i] + b.variance[i]) + 1e-5 * b.mean[i] + 1e-9;
      // Rare bright paths, as splats of surfaces right before the eye, make errors that renders as few do not know.
      if (error > kMostNoise * b.mean[i]) continue;
      worst = std::max(worst, std::abs(a.mean[i] - b.mean[i]) / error);
    }
    return worst;
  }
};

// By t-tests of 14 degrees of freedom at most in 7 parts: beyond 6 by chance once in 5,000.
TEST_F(CrossCheck, AllFindTheLightOfPaths) {
  constexpr double kMost = 6.0;
  const Range range = asked_for();
  const bool tells = std::getenv("WAVEPATH_CROSS_CHECK") != nullptr;
  for (std::uint32_t seed = range.first; seed < range.first + range.count; ++seed) {
    const BodyScene made = body_scene_of(seed);
    SCOPED_TRACE(fmt::format("WAVEPATH_CROSS_CHECK={}:1", seed));
    const std::vector<Way> all = ways(made, 5, tells ? 32 : 16);
    std::optional<Average> expected;
    std::size_t judged = 0;
    for (const Way& way : all) {
      const Average found = average(Subject(made.scene, way.settings), way.settings);
      if (way.is_expected) expected = found;
      const double apart = worst(found, *expected);
      if (tells)
        fmt::print("{:3} {:30} {:.5f} +- {:.5f}  {:6.2f}{}\n", seed, way.name, found.mean[0],
                   std::sqrt(found.variance[0]), apart, apart > kMost ? "  APART" : ""),
            std::fflush(stdout);
      EXPECT_LE(apart, kMost) << way.name;
      judged += apart >= 0.0 ? 1 : 0;
    }
    EXPECT_GT(2 * judged, all.size()) << "noise hides the rest";
  }
}

} // namespace
} // namespace wavepath::test
