// How many paths a wave may have, as dispatches are reported.
#include "host/render/loop/governor.h"

#include <gtest/gtest.h>

namespace wavepath::test {
namespace {

constexpr std::uint32_t kPlenty = 1u << 24; // slots that no wave here fills
constexpr double kLongest = 0.125;          // seconds; a power of two, so that the expected lengths are exact

TEST(Governor, BeginsWithAWaveThatFitsIntoTheSlots) {
  EXPECT_EQ(Governor(700).wave(), 700u);
  const std::uint32_t first = Governor(kPlenty).wave();
  EXPECT_LT(first, kPlenty);
  EXPECT_EQ(Governor(first).wave(), first);
}

TEST(Governor, HalvesWhenADispatchTookTooLong) {
  Governor governor(kPlenty, kLongest);
  const std::uint32_t first = governor.wave();
  governor.report(kLongest, first);
  EXPECT_EQ(governor.wave(), first) << "just long enough";
  governor.report(1.01 * kLongest, first);
  EXPECT_EQ(governor.wave(), first / 2);
  governor.report(1000.0 * kLongest, first / 2);
  EXPECT_EQ(governor.wave(), first / 4);
}

// Of the paths that took too long, be they fewer than the wave may have: the last of a picture, or of a segment.
TEST(Governor, HalvesTheWaveThatTookTooLong) {
  Governor governor(kPlenty, kLongest);
  governor.report(2.0 * kLongest, 1000);
  EXPECT_EQ(governor.wave(), 500u);
  // Two waves are in flight: one that was longer than waves are by now was recorded before that was known.
  governor.report(2.0 * kLongest, 8000);
  EXPECT_EQ(governor.wave(), 250u);
}

TEST(Governor, NeverHalvesBelowAWorkgroup) {
  Governor governor(kPlenty, kLongest);
  for (int i = 0; i < 40; ++i) governor.report(2.0 * kLongest, governor.wave());
  EXPECT_EQ(governor.wave(), gpu::kWorkgroupSize);
  governor.report(2.0 * kLongest, 1);
  EXPECT_EQ(governor.wave(), gpu::kWorkgroupSize);
  Governor small(gpu::kWorkgroupSize / 2, kLongest);
  small.report(2.0 * kLongest, small.wave());
  EXPECT_EQ(small.wave(), gpu::kWorkgroupSize / 2) << "there are no more slots";
}

TEST(Governor, GrowsAtOnceToHalfOfTheTimeAllowed) {
  for (const std::uint32_t times : {3u, 4u, 8u}) {
    Governor governor(kPlenty, kLongest);
    const std::uint32_t first = governor.wave();
    governor.report(kLongest / 2 / times * (1.0 - 1e-12), first);
    EXPECT_EQ(governor.wave(), times * first);
  }
}

TEST(Governor, GrowsToNoMoreThanEightTimesAsManyPaths) {
  for (const double seconds : {kLongest / 17, kLongest * 1e-6, 0.0}) {
    Governor governor(kPlenty, kLongest);
    const std::uint32_t first = governor.wave();
    governor.report(seconds, first);
    EXPECT_EQ(governor.wave(), 8 * first) << seconds;
    governor.report(seconds, 5 * first);
    EXPECT_EQ(governor.wave(), 40 * first) << seconds << ": of the paths that were that fast";
  }
}

// Lengths that went up and down with every report would be of no use.
TEST(Governor, StaysWhereThereIsNoTimeForTwiceAsManyPaths) {
  Governor governor(kPlenty, kLongest);
  const std::uint32_t first = governor.wave();
  for (const double fraction : {0.25, 0.3, 0.5, 0.99, 1.0}) {
    governor.report(fraction * kLongest, first);
    EXPECT_EQ(governor.wave(), first) << fraction;
  }
}

// Fewer paths are fast whatever the device is.
TEST(Governor, DoesNotGrowForAWaveThatWasCutShort) {
  Governor governor(kPlenty, kLongest);
  const std::uint32_t first = governor.wave();
  for (const std::uint32_t paths : {1u, first / 4, first / 2}) {
    governor.report(kLongest / 1000, paths);
    EXPECT_EQ(governor.wave(), first) << paths;
  }
  governor.report(kLongest / 1000, first / 2 + 1);
  EXPECT_EQ(governor.wave(), 8 * (first / 2 + 1));
}

TEST(Governor, NeverGrowsBeyondTheSlots) {
  const std::uint32_t slots = 2 * Governor(kPlenty).wave() + 77;
  Governor governor(slots, kLongest);
  for (int i = 0; i < 3; ++i) {
    governor.report(kLongest / 1000, governor.wave());
    EXPECT_EQ(governor.wave(), slots);
  }
}

} // namespace
} // namespace wavepath::test
