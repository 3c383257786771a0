// Shadow volumes.
#include "tests/shadow_scene.h"

#include <gtest/gtest.h>
namespace wavepath::test {
namespace {
class VolumeTest : public ShadowTest {};
TEST_F(VolumeTest, Probe) {
  for (const auto& [name, scene] :
       {std::pair{"sun", lit_by(sun())}, {"spot", lit_by(spot())}, {"lamp", lit_by(lamp())}}) {
    const FalseShares f = false_shares(light(scene, shadow_settings("traced")), light(scene, shadow_settings("zfail")));
    printf("%s %g %g\n", name, f.lit * 96 * 72, f.dark * 96 * 72);
  }
}
} // namespace
} // namespace wavepath::test
