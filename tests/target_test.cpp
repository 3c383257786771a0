// The rule by which a render stops at its target: when it looks, how far it may go meanwhile, and when it ends.
#include "host/render/loop/target.h"

#include <cmath>

#include <gtest/gtest.h>

namespace wavepath::test {
namespace {

Checkpoint found(std::uint32_t spp, double error) {
  Checkpoint point;
  point.spp = spp;
  point.error.relative_rms = error;
  return point;
}

// The error of noise: 1 / sqrt(spp).
Checkpoint noise(std::uint32_t spp) { return found(spp, 1.0 / std::sqrt(spp)); }

TEST(Target, NoneNeverEndsNorBounds) {
  Target target;
  target.begin(64, 64);
  EXPECT_EQ(target.limit(), 0u);
  EXPECT_FALSE(target.take(64, found(64, 0.0), {}));
  EXPECT_EQ(target.next_check(), 0u);
}

TEST(Target, EndsWhereTheErrorIsSmallEnough) {
  Target target(0.1, 0, 1000, 2);
  target.begin(64, 64);
  EXPECT_FALSE(target.take(64, found(64, 0.101), {}));
  target.begin(70, 70);
  EXPECT_TRUE(target.take(70, found(70, 0.1), {}));
  EXPECT_EQ(target.limit(), 0u);
  EXPECT_EQ(target.next_check(), 70u) << "resumed from here, it has reached its target already";
}

// Few samples may have missed rare light.
TEST(Target, FewSamplesEndNothing) {
  Target target(0.1, 0, 1000, 2);
  target.begin(8, 8);
  EXPECT_EQ(target.limit(), 0u) << "a look that cannot end the render does not hold it up";
  EXPECT_FALSE(target.take(8, found(8, 0.0), {}));
  target.begin(16, 16);
  EXPECT_GT(target.limit(), 16u);
  EXPECT_TRUE(target.take(16, found(16, 0.0), {}));
}

// Where a look is due depends on what was found, never on when that became known: however slow the estimate is,
// rendering waits before the first sample at which the next look might be due.
TEST(Target, TheLimitIsNoLaterThanTheNextLook) {
  for (const double error : {0.1001, 0.15, 0.5, 10.0})
    for (const std::uint32_t sample : {16u, 64u, 100u, 1024u}) {
      Target target(0.1, 0, 1u << 20, 2);
      target.begin(sample, sample);
      const std::uint32_t limit = target.limit();
      EXPECT_GT(limit, sample);
      std::vector<Checkpoint> checkpoints;
      for (std::uint32_t spp = 2; spp <= sample; spp *= 2) checkpoints.push_back(noise(spp));
      EXPECT_FALSE(target.take(sample, found(sample, error), checkpoints));
      EXPECT_GE(target.next_check(), limit) << error << " at " << sample;
      EXPECT_EQ(target.limit(), 0u);
    }
}

// With noise that falls as 1 / sqrt(n) the look is where the target is met, no farther than twice as many samples.
TEST(Target, LooksWhereTheErrorIsPredictedToBe) {
  const std::vector<Checkpoint> checkpoints = {noise(16), noise(32), noise(64), noise(128)};
  Target target(1.0 / std::sqrt(160.0), 0, 1u << 20, 2);
  target.begin(128, 128);
  EXPECT_FALSE(target.take(128, noise(128), checkpoints));
  EXPECT_GE(target.next_check(), 160u);
  EXPECT_LE(target.next_check(), 164u);
  Target far(1e-3, 0, 1u << 20, 2);
  far.begin(128, 128);
  EXPECT_FALSE(far.take(128, noise(128), checkpoints));
  EXPECT_LE(far.next_check(), 2 * 128u + 2u);
}

// All replicates have as many samples at a look, counted from the first sample of the range.
TEST(Target, LooksAreWholeStepsApart) {
  for (const std::uint32_t step : {2u, 4u}) {
    Target target(0.01, 8, 1u << 20, step);
    target.begin(108, 100);
    EXPECT_EQ((target.limit() - 108) % step, 0u);
    EXPECT_FALSE(target.take(108, found(100, 0.011), {noise(25), noise(50), noise(100)}));
    EXPECT_EQ((target.next_check() - 108) % step, 0u);
  }
}

TEST(Target, ALaterLookKeepsItsLimit) {
  Target target(0.1, 0, 1000, 2);
  target.begin(64, 64);
  target.begin(68, 68);
  const std::uint32_t limit = target.limit();
  EXPECT_FALSE(target.take(64, found(64, 0.2), {}));
  EXPECT_EQ(target.limit(), limit) << "the look at 68 is not known yet";
}

// Indices end at 2^32 - 1: what lies beyond is there, not at the beginning.
TEST(Target, NothingLiesBeyondTheLastIndex) {
  constexpr std::uint32_t kFirst = 0xffffff00, kLast = 0xffffffff;
  Target target(0.1, kFirst, kLast, 2);
  target.begin(kLast - 3, kLast - 3 - kFirst);
  EXPECT_EQ(target.limit(), kLast);
  EXPECT_FALSE(target.take(kLast - 3, found(kLast - 3 - kFirst, 0.5), {noise(64), noise(128)}));
  EXPECT_EQ(target.next_check(), kLast);
}

TEST(Target, NoLimitBeyondTheEnd) {
  Target target(0.1, 0, 66, 2);
  target.begin(64, 64);
  EXPECT_EQ(target.limit(), 66u);
}

} // namespace
} // namespace wavepath::test
