// Trees of an object that is packed in one pose after another: valid over all triangles, and built over few.
#include <random>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bvh/geometry.h"
#include "bvh/validate.h"
#include "host/scene/pack/kept_tree.h"

namespace wavepath::test {
namespace {

std::vector<bvh::Triangle> scattered(std::size_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(-10.0f, 10.0f), size(-0.5f, 0.5f);
  std::vector<bvh::Triangle> triangles;
  for (std::size_t i = 0; i < count; ++i) {
    const bvh::Vec3 p{place(random), place(random), place(random)};
    const auto near = [&] { return p + bvh::Vec3{size(random), size(random), size(random)}; };
    triangles.push_back({near(), near(), near()});
  }
  return triangles;
}

void shift(bvh::Triangle& triangle, float by) {
  for (bvh::Vec3* p : {&triangle.v0, &triangle.v1, &triangle.v2}) p->x += by;
}

class KeptTreeTest : public testing::TestWithParam<bvh::Quality> {
protected:
  // Builds, and returns how many triangles trees were built over.
  std::uint64_t build() {
    trees_.built = 0;
    bvh::BuildReport report;
    const bvh::WideTree tree = build_again(triangles_, {.quality = GetParam()}, trees_, 0, report);
    for (const std::string& wrong : bvh::validate(tree, std::span<const bvh::Triangle>(triangles_)))
      ADD_FAILURE() << wrong;
    bvh::Box all;
    for (const bvh::Triangle& t : triangles_) all = bvh::merge(bvh::merge(bvh::merge(all, t.v0), t.v1), t.v2);
    EXPECT_LE(report.box.lo.x, all.lo.x);
    EXPECT_GE(report.box.hi.x, all.hi.x);
    return trees_.built;
  }

  std::vector<bvh::Triangle> triangles_ = scattered(2000);
  KeptTrees trees_;
};

TEST_P(KeptTreeTest, IsBuiltOverWhatMoves) {
  EXPECT_EQ(build(), 2000u);
  EXPECT_EQ(build(), 0u); // nothing moved
  for (std::size_t t = 100; t < 130; ++t) shift(triangles_[t], 30.0f);
  EXPECT_EQ(build(), 2000u); // 1,970 that stay, once, and 30
  for (std::size_t t = 100; t < 130; ++t) shift(triangles_[t], -3.0f);
  EXPECT_EQ(build(), 30u);
  EXPECT_EQ(build(), 0u);
  shift(triangles_[5], 1.0f); // one more begins to move
  EXPECT_EQ(build(), 2000u);
  shift(triangles_[5], 1.0f);
  EXPECT_EQ(build(), 31u);
  for (bvh::Triangle& triangle : triangles_) shift(triangle, 0.25f);
  EXPECT_EQ(build(), 2000u);
  triangles_.pop_back();
  EXPECT_EQ(build(), 1999u);
}

INSTANTIATE_TEST_SUITE_P(Qualities, KeptTreeTest,
                         testing::Values(bvh::Quality::fast, bvh::Quality::balanced, bvh::Quality::best));

} // namespace
} // namespace wavepath::test
