// Virtual shadow maps: the answers of the map of the same size, from a part of its texels.
#include "tests/long_scene.h"

#include <gtest/gtest.h>

#include "host/integrators/hybrid/shadows/virtual_pages.h"

namespace wavepath::test {
namespace {

TEST_F(ShadowTest, PagesAnswerAsTheMapOfTheSameSize) {
  for (const Scene& scene : {lit_by(sun()), lit_by(spot()), lit_by(lamp())})
    for (const std::uint32_t size : {100u, 512u})
      for (const std::uint32_t source : {kShadowSourceRaster, kShadowSourceTraced}) {
        SCOPED_TRACE(size);
        RenderPlan paged = shadow_settings("virtual", size), whole = shadow_settings("map", size);
        paged.shadow_source = whole.shadow_source = source;
        EXPECT_EQ(light(scene, paged), light(scene, whole));
      }
}

TEST_F(ShadowTest, PagesArePartOfTheMap) {
  const Scene scene = long_rows(sun());
  const RenderResult paged = render(scene, shadow_settings("virtual", 4096)),
                     whole = render(scene, shadow_settings("map", 4096));
  ASSERT_TRUE(paged.shadows && whole.shadows);
  EXPECT_EQ(paged.shadows->pages, 32u * 32u);
  EXPECT_GT(paged.shadows->resident_pages, 10u);
  EXPECT_LT(paged.shadows->resident_pages, paged.shadows->pages / 2);
  EXPECT_LT(paged.shadows->bytes, whole.shadows->bytes / 2);
  EXPECT_EQ(paged.picture.channels[1].values, whole.picture.channels[1].values);
}

// Six views of 4096 x 4096 texels are more than buffers of texels hold on some devices.
TEST_F(ShadowTest, PagesFitWhereMapsDoNot) {
  const Scene scene = lit_by(lamp());
  const std::vector<float> truth = light(scene, shadow_settings("traced"));
  const RenderResult result = render(scene, shadow_settings("virtual", 4096));
  EXPECT_LT(result.shadows->bytes, std::uint64_t{6} * 4096 * 4096 * 4 / 3);
  EXPECT_LT(false_fractions(truth, result.picture.channels[1].values).total(), 0.001);
}

// A page for nearly every pixel: those beyond what the device holds are traced.
TEST_F(ShadowTest, RaysToPagesThatFindNoRoomAreTraced) {
  const Scene scene = lit_by(spot());
  const std::vector<float> truth = light(scene, shadow_settings("traced"));
  const RenderResult result = render(scene, shadow_settings("virtual", 16384));
  EXPECT_LE(std::uint64_t{result.shadows->resident_pages} * gpu::kShadowPage * gpu::kShadowPage,
            device().info().max_texel_elements);
  EXPECT_LT(false_fractions(truth, result.picture.channels[1].values).total(), 0.001);
}

// Each frame sees other points; the pages that it adds join those of the frames before.
TEST_F(ShadowTest, MorePagesComeWithMoreFrames) {
  const Scene scene = lit_by(spot());
  RenderPlan one = shadow_settings("virtual", 4096), many = one, map = shadow_settings("map", 4096);
  many.last_sample = map.last_sample = 5;
  const RenderResult result = render(scene, many);
  EXPECT_EQ(result.picture.channels[1].values, light(scene, map));
  EXPECT_GT(result.shadows->resident_pages, render(scene, one).shadows->resident_pages);
}

TEST(VirtualPages, ResidentPagesHaveSlotsOfTheirOwn) {
  VirtualPages pages(2, 300); // 3 x 3 pages a view
  ASSERT_EQ(pages.total(), 18u);
  std::vector<std::uint32_t> asked(18);
  asked[4] = asked[17] = 1;
  pages.add(asked, 18);
  pages.add(asked, 18);
  EXPECT_EQ(pages.resident(), 2u);
  asked[0] = 1;
  pages.add(asked, 2);
  EXPECT_EQ(pages.resident(), 2u); // there is no room
  pages.add(asked, 18);
  const std::vector<std::uint32_t> table = pages.table();
  ASSERT_EQ(table.size(), 21u);
  EXPECT_EQ(table[4], 0u);
  EXPECT_EQ(table[17], 1u);
  EXPECT_EQ(table[0], 2u);
  EXPECT_EQ(table[1], gpu::kNone);
  EXPECT_EQ((std::vector<std::uint32_t>(table.begin() + 18, table.end())), (std::vector<std::uint32_t>{4, 17, 0}));
  const std::vector<PageTile> tiles = pages.tiles(0);
  ASSERT_EQ(tiles.size(), 2u);                          // one a view
  EXPECT_EQ(tiles[1].pages.front().width, 300u - 256u); // at the view's end
  EXPECT_EQ(pages.tiles(2).size(), 1u);
}

} // namespace
} // namespace wavepath::test
