// Leak tracing: as good as tracing every ray, for a part of the rays.
#include "tests/shadow_scene.h"

#include <gtest/gtest.h>

namespace wavepath::test {
namespace {

double error(const std::vector<float>& truth, const std::vector<float>& picture) {
  double sum = 0.0, whole = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) sum += std::abs(truth[i] - picture[i]), whole += truth[i];
  return sum / whole;
}

class LeakTest : public ShadowTest {};

// A coarse map costs rays, not light.
TEST_F(LeakTest, CoarseMapsLeaveMoreRays) {
  const Scene scene = lit_by(spot());
  const std::vector<float> truth = light(scene, shadow_settings("traced"));
  std::uint64_t before = ~std::uint64_t{0};
  for (const std::uint32_t size : {32u, 128u, 512u}) {
    const RenderResult result = render(scene, shadow_settings("leak", size));
    EXPECT_LT(error(truth, result.picture.channels[1].values), 1e-3);
    EXPECT_LT(error(truth, result.picture.channels[1].values),
              0.05 * error(truth, light(scene, shadow_settings("moment", size))));
    EXPECT_LT(result.shadows->answers->traced, before / 2);
    before = result.shadows->answers->traced;
  }
}

// What no texel has seen is in no shadow.
TEST_F(LeakTest, WiresBetweenTexelsAreLost) {
  Scene scene = lit_by(spot());
  add_instance(scene, add_mesh(scene, box({0.1f, 1.6f, 0.2f}, {0.004f, 0.004f, 1.0f})));
  const std::vector<float> truth = light(scene, shadow_settings("traced"));
  const double coarse = error(truth, light(scene, shadow_settings("leak", 64))),
               fine = error(truth, light(scene, shadow_settings("leak", 2048)));
  EXPECT_GT(coarse, 1e-3);
  EXPECT_LT(fine, 0.1 * coarse);
}

TEST_F(LeakTest, OthersCountNothing) {
  EXPECT_FALSE(render(lit_by(sun()), shadow_settings("moment", 64)).shadows->answers);
}

TEST_F(LeakTest, TracesWhereMapsLeakAndNoMore) {
  for (const auto& [name, scene] :
       {std::pair{"sun", lit_by(sun())}, {"spot", lit_by(spot())}, {"lamp", lit_by(lamp())}}) {
    SCOPED_TRACE(name);
    const std::vector<float> truth = light(scene, shadow_settings("traced"));
    const double filtered = error(truth, light(scene, shadow_settings("moment")));
    const RenderResult result = render(scene, shadow_settings("leak"));
    const double mixed = error(truth, result.picture.channels[1].values);
    ASSERT_TRUE(result.shadows && result.shadows->answers);
    const auto [answered, traced] = *result.shadows->answers;
    EXPECT_LT(mixed, 0.02 * filtered);
    EXPECT_GT(answered, 4 * traced);
    EXPECT_GT(traced, 0u);
  }
}

} // namespace
} // namespace wavepath::test
