// Lightmaps: texels hold what rays from their points find, and what is between them is interpolated in the atlas.
#include "tests/shadow_scene.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/shadows/lightmap_charts.h"
#include "kernels/shadows/lightmap_types.h"

namespace wavepath::test {
namespace {

class LightmapTest : public ShadowTest {};

TEST_F(LightmapTest, ConvergesToTracedShadows) {
  for (const auto& [name, scene] :
       {std::pair{"sun", lit_by(sun())}, {"spot", lit_by(spot())}, {"lamp", lit_by(lamp())}}) {
    SCOPED_TRACE(name);
    const std::vector<float> truth = light(scene, shadow_settings("traced"));
    RenderSettings settings = shadow_settings("lightmap", 64);
    const auto error = [&](std::uint32_t size) {
      settings.shadow_size = size;
      const std::vector<float> picture = light(scene, settings);
      double sum = 0.0, all = 0.0;
      for (std::size_t i = 0; i < truth.size(); ++i) sum += std::abs(picture[i] - truth[i]), all += truth[i];
      return sum / all;
    };
    const double coarse = error(64), fine = error(256), finest = error(1024);
    fmt::print("{} {} {} {}\n", name, coarse, fine, finest);
    EXPECT_LT(fine, 0.5 * coarse);
    EXPECT_LT(finest, 0.5 * fine);
  }
}

} // namespace
} // namespace wavepath::test
