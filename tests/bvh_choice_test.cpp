// Which tree is built for how many rays.
#include <gtest/gtest.h>

#include "host/plan/bvh_quality.h"

namespace wavepath::test {
namespace {

using bvh::Quality;

Quality choose(std::uint32_t spp, const char* device, double time_limit = 0.0, std::uint64_t triangles = 1'000'000) {
  RenderPlan settings;
  settings.width = 1000, settings.height = 1000;
  settings.last_sample = spp;
  settings.time_limit = time_limit;
  DeviceInfo info;
  info.type = device;
  return choose_quality(settings, triangles, info);
}

TEST(BvhChoice, GrowsWithTheNumberOfRays) {
  EXPECT_EQ(choose(1, "cpu"), Quality::fast);
  EXPECT_EQ(choose(2, "cpu"), Quality::balanced) << "a sample is several rays";
  EXPECT_EQ(choose(4, "cpu"), Quality::balanced);
  EXPECT_EQ(choose(64, "cpu"), Quality::best);
  EXPECT_EQ(choose(64, "cpu", 0.0, 1'000'000'000), Quality::fast);
  EXPECT_EQ(choose(1, "cpu", 0.0, 0), Quality::best) << "nothing to build";
}

TEST(BvhChoice, AFastDeviceHasLessToGain) {
  EXPECT_EQ(choose(64, "discrete"), Quality::fast);
  EXPECT_EQ(choose(65536, "discrete"), Quality::best);
}

TEST(BvhChoice, ATimeLimitBoundsTheRays) {
  EXPECT_EQ(choose(65536, "cpu", 0.5), Quality::fast);
  EXPECT_EQ(choose(65536, "cpu", 600.0), Quality::best);
}

} // namespace
} // namespace wavepath::test
