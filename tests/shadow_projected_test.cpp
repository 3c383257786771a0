// Projected shadows: on planes, those of planar shadows up to a texel; and pictures that lights are shone through.
#include "tests/shadow_scene.h"

#include <gtest/gtest.h>

#include <filesystem>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/film/picture_io.h"
#include "host/integrators/shadows/catalogue.h"

namespace wavepath::test {
namespace {

constexpr int kWidth = 96, kHeight = 72;

RenderSettings settings_of(std::string_view technique) {
  return shadow_settings(technique, technique == "projected" ? 2048 : RenderSettings{}.shadow_size);
}

class ProjectedTest : public ShadowTest {};

// Texels of this size are smaller than pixels, so that only pixels next to an edge may differ.
TEST_F(ProjectedTest, ShadowsArePlanarOnes) {
  for (const auto& [name, scene] :
       {std::pair{"sun", lit_by(sun())}, {"spot", lit_by(spot())}, {"lamp", lit_by(lamp())}}) {
    SCOPED_TRACE(name);
    const std::vector<float> planar = light(scene, settings_of("planar")),
                             picture = light(scene, settings_of("projected"));
    RenderSettings bright = settings_of("planar");
    bright.shadow_ambient = 1.0;
    const std::vector<float> whole = light(scene, bright);
    int dark = 0, wrong = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const int i = y * kWidth + x;
        dark += planar[i] < whole[i];
        if (planar[i] == picture[i]) continue;
        ++wrong;
        bool is_edge = false;
        for (int v = std::max(y - 1, 0); v <= std::min(y + 1, kHeight - 1); ++v)
          for (int u = std::max(x - 1, 0); u <= std::min(x + 1, kWidth - 1); ++u)
            is_edge |= (planar[v * kWidth + u] < whole[v * kWidth + u]) != (planar[i] < whole[i]);
        EXPECT_TRUE(is_edge) << x << " " << y << ": " << planar[i] << " " << picture[i];
      }
    EXPECT_GT(dark, 100);
    EXPECT_LT(wrong, 60);
  }
}

} // namespace
} // namespace wavepath::test
