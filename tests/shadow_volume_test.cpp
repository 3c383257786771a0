// Shadow volumes: traced shadows but for what the rasterizer moves at edges, and what becomes of z-pass where the eye
// is in shadow.
#include "tests/shadow_scene.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/base/error.h"

namespace wavepath::test {
namespace {

class VolumeTest : public ShadowTest {
protected:
  // Pixels whose light differs, each of which has lit and dark ones around it in the truth.
  std::size_t differing(const std::vector<float>& truth, const std::vector<float>& picture, std::uint32_t width) {
    std::size_t count = 0;
    const auto height = static_cast<std::ptrdiff_t>(truth.size() / width);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      if (std::abs(truth[i] - picture[i]) <= 1e-5f * std::max(truth[i], picture[i])) continue;
      ++count;
      bool lit = false, dark = false;
      const auto x = static_cast<std::ptrdiff_t>(i % width), y = static_cast<std::ptrdiff_t>(i / width);
      for (std::ptrdiff_t v = std::max<std::ptrdiff_t>(y - 1, 0); v <= std::min(y + 1, height - 1); ++v)
        for (std::ptrdiff_t u = std::max<std::ptrdiff_t>(x - 1, 0); u <= std::min<std::ptrdiff_t>(x + 1, width - 1);
             ++u)
          (truth[static_cast<std::size_t>(v * width + u)] > 0.0f ? lit : dark) = true;
      EXPECT_TRUE(lit && dark) << x << ", " << y << ": " << truth[i] << ", " << picture[i];
    }
    return count;
  }
};

// A sheet above the floor, and a mesh that is placed three times, once mirrored.
Scene open_and_placed() {
  Scene scene = bodies();
  add_instance(scene, add_mesh(scene, rectangle({-0.9f, 0.6f, -0.6f}, {0.3f, 0.1f, 0}, {0, 0.05f, 0.3f})));
  const std::uint32_t mesh = add_mesh(scene, box({0, 0, 0}, {0.1f, 0.2f, 0.15f}));
  for (const double side : {-1.0, 0.8})
    add_instance(scene, mesh, glm::rotate(glm::translate(glm::dmat4(1.0), {0.9, 0.4, side}), 0.4, glm::dvec3(1, 2, 0)));
  add_instance(scene, mesh, glm::scale(glm::translate(glm::dmat4(1.0), {-1.0, 0.5, 0.9}), {-1.5, 1.0, 1.0}));
  scene.materials[0].double_sided = true;
  return scene;
}

TEST_F(VolumeTest, CountedBehindWhatIsSeenAreTracedShadows) {
  for (const bool open : {false, true})
    for (const auto& [name, light_of] : {std::pair{"sun", sun()}, {"spot", spot()}, {"lamp", lamp()}}) {
      SCOPED_TRACE(std::string(name) + (open ? ", open" : ""));
      Scene scene = open ? open_and_placed() : bodies();
      scene.lights = {light_of};
      const RenderPlan settings = shadow_settings("zfail");
      const std::vector<float> truth = light(scene, shadow_settings("traced"));
      EXPECT_GT(std::ranges::count(truth, 0.0f), 200);
      EXPECT_LT(static_cast<double>(differing(truth, light(scene, settings), settings.width)),
                0.01 * static_cast<double>(truth.size()));
    }
}

TEST_F(VolumeTest, BothCountsAgreeWhereTheEyeIsLit) {
  for (const auto& light_of : {sun(), spot(), lamp()}) {
    Scene scene = bodies();
    scene.instances.erase(scene.instances.begin()); // the floor is open
    add_instance(scene, add_mesh(scene, box({0, -0.5f, 0}, {3, 0.5f, 3})));
    scene.lights = {light_of};
    const std::vector<float> behind = light(scene, shadow_settings("zfail"));
    EXPECT_EQ(light(scene, shadow_settings("zpass")), behind);
    EXPECT_GT(std::ranges::count(behind, 0.0f), 200);
  }
}

// A body between the eye and the sun: z-pass takes the eye for lit, so that what lies in one volume fewer than the eye
// is lit.
TEST_F(VolumeTest, CountedInFrontAreWrongWhereTheEyeIsInShadow) {
  Scene scene = bodies();
  scene.instances.erase(scene.instances.begin());
  add_instance(scene, add_mesh(scene, box({0, -0.5f, 0}, {3, 0.5f, 3})));
  add_instance(scene, add_mesh(scene, box({0.5f, 4.5f, 3.4f}, {0.2f, 0.2f, 0.2f})));
  scene.lights = {sun({0, -1, 0})};
  const std::vector<float> truth = light(scene, shadow_settings("traced"));
  const RenderPlan settings = shadow_settings("zfail");
  EXPECT_LT(differing(truth, light(scene, settings), settings.width), truth.size() / 100);
  EXPECT_GT(false_fractions(truth, light(scene, shadow_settings("zpass"))).dark, 0.3);
}

TEST_F(VolumeTest, SameBitsHoweverTheWorkIsCut) {
  const Scene scene = lit_by(lamp());
  RenderPlan settings = shadow_settings("zfail");
  settings.last_sample = 3;
  const std::vector<float> whole = light(scene, settings);
  settings.wave_slots = 1000;
  EXPECT_EQ(light(scene, settings), whole);
}

TEST_F(VolumeTest, LightInShadowIsAFractionOfTheLight) {
  const Scene scene = lit_by(spot());
  RenderPlan settings = shadow_settings("zfail");
  const std::vector<float> dark = light(scene, settings);
  settings.shadow_ambient = 1.0;
  const std::vector<float> lit = light(scene, settings);
  settings.shadow_ambient = 0.25;
  const std::vector<float> some = light(scene, settings);
  for (std::size_t i = 0; i < lit.size(); ++i)
    ASSERT_NEAR(some[i], dark[i] + 0.25f * (lit[i] - dark[i]), 1e-5f * lit[i]);
}

TEST_F(VolumeTest, RefuseWhatTheyCannotDo) {
  const auto refusal = [&](const Scene& scene, std::string_view technique) {
    try {
      render(scene, shadow_settings(technique, 64));
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  Scene scene = lit_by(sun());
  EXPECT_NE(refusal(scene, "zpass").find("closed meshes"), std::string::npos);
  EXPECT_EQ(refusal(scene, "zfail"), "");
  scene.cameras[0] = camera_above({0, 0, 0}, 1.0);
  EXPECT_NE(refusal(scene, "zfail").find("--shadows zfail"), std::string::npos);
}

} // namespace
} // namespace wavepath::test
