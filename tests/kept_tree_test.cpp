// Trees of an object that is packed in one pose after another: valid over all triangles, and built over few.
#include <cstring>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bvh/geometry.h"
#include "bvh/measure.h"
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
    check(build_again(triangles_, {.quality = GetParam()}, trees_, 0));
    return trees_.built;
  }

  void check(const KeptTree& kept) {
    for (const std::string& wrong : bvh::validate(kept.tree, std::span<const bvh::Triangle>(triangles_)))
      ADD_FAILURE() << wrong;
    bvh::Box all;
    for (const bvh::Triangle& t : triangles_) all = bvh::merge(bvh::merge(bvh::merge(all, t.v0), t.v1), t.v2);
    EXPECT_LE(kept.box.lo.x, all.lo.x);
    EXPECT_GE(kept.box.hi.x, all.hi.x);
    EXPECT_NEAR(kept.sah_cost, bvh::measure(kept.tree).sah_cost,
                0.1 * kept.sah_cost); // boxes are looser where some left
  }

  std::vector<bvh::Triangle> triangles_ = scattered(2000);
  KeptTrees trees_;
};

TEST_P(KeptTreeTest, IsBuiltOverWhatMoves) {
  EXPECT_EQ(build(), 2000u);
  EXPECT_EQ(build(), 0u); // nothing moved
  for (std::size_t t = 100; t < 130; ++t) shift(triangles_[t], 30.0f);
  EXPECT_EQ(build(), 30u); // of the others, the tree over all is left
  for (std::size_t t = 100; t < 130; ++t) shift(triangles_[t], -3.0f);
  EXPECT_EQ(build(), 30u);
  EXPECT_EQ(build(), 0u);
  shift(triangles_[5], 1.0f); // one more begins to move
  EXPECT_EQ(build(), 31u);
  shift(triangles_[5], 1.0f);
  EXPECT_EQ(build(), 31u);
  for (bvh::Triangle& triangle : triangles_) shift(triangle, 0.25f);
  EXPECT_EQ(build(), 2000u);
  triangles_.pop_back();
  EXPECT_EQ(build(), 1999u);
}

// One after another begins to move, and the others rest: what has moved is not built again for ever.
TEST_P(KeptTreeTest, IsBuiltAnewOnceMuchThatMovedRests) {
  build();
  std::uint64_t most = 0, whole = 0;
  for (std::size_t first = 0; first + 50 <= 2000; first += 50) {
    for (std::size_t t = first; t < first + 50; ++t) shift(triangles_[t], 3.0f);
    const std::uint64_t built = build();
    if (built == 2000)
      ++whole;
    else
      most = std::max(most, built);
  }
  EXPECT_LE(most, 300u); // an eighth of them, and those of the step
  EXPECT_LE(whole, 7u);
}

// Where triangles go from, the tree is about as good as one that is built without them.
TEST_P(KeptTreeTest, IsAboutAsGoodAsABuild) {
  build();
  for (std::size_t t = 0; t < 200; ++t) shift(triangles_[t], 0.5f);
  build();
  const bvh::WideTree anew = bvh::build(std::span<const bvh::Triangle>(triangles_), {.quality = GetParam()});
  EXPECT_LT(trees_.of_objects[0].sah_cost, 1.5 * bvh::measure(anew).sah_cost);
}

// What moves is told, instead of found by comparing all.
TEST_P(KeptTreeTest, IsToldWhatMoves) {
  build();
  const auto move = [&](std::uint32_t first, std::size_t count, float by) {
    MovedTriangles some{first, {}};
    for (std::size_t t = first; t < first + count; ++t) {
      shift(triangles_[t], by);
      some.triangles.push_back(triangles_[t]);
    }
    return some;
  };
  KeptTree& kept = trees_.of_objects[0];
  const auto tell = [&](const std::vector<MovedTriangles>& moved) {
    const bool goes_on = move_again(moved, GetParam(), kept, trees_.built);
    check(kept);
    return goes_on;
  };
  EXPECT_FALSE(tell({move(100, 30, 30.0f), move(700, 5, 1.0f)}));
  const std::vector<bvh::WideNode> nodes = kept.tree.nodes;
  const std::vector<std::uint32_t> order = kept.tree.order;
  trees_.built = 0;
  EXPECT_TRUE(tell({move(100, 30, -50.0f)}));
  EXPECT_EQ(trees_.built, 35u);
  const std::size_t still = kept.still.order.size(), inner = kept.still.nodes.size() - 1;
  EXPECT_TRUE(std::equal(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(still), kept.tree.order.begin()));
  for (std::size_t n = 3; n < 3 + inner; ++n)
    EXPECT_EQ(std::memcmp(&nodes[n], &kept.tree.nodes[n], sizeof(bvh::WideNode)), 0) << n;
  EXPECT_FALSE(tell({move(1000, 1, 1.0f)})); // that had not moved
  EXPECT_EQ(build(), 0u);                    // comparing finds nothing else
}

INSTANTIATE_TEST_SUITE_P(Qualities, KeptTreeTest,
                         testing::Values(bvh::Quality::fast, bvh::Quality::balanced, bvh::Quality::best));

} // namespace
} // namespace wavepath::test
