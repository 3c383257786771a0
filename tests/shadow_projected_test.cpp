// Projected shadows: on planes, those of planar shadows up to a texel; and pictures that lights are shone through.
#include "tests/shadow_scene.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <tuple>

#include <unistd.h>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/shadows/catalogue.h"
#include "host/picture/files/picture_io.h"
#include "host/render/settings/identity.h"

namespace wavepath::test {
namespace {

constexpr int kWidth = 96, kHeight = 72;

RenderPlan settings_of(std::string_view technique) {
  return shadow_settings(technique, technique == "projected" ? 2048 : RenderPlan{}.shadow_size);
}

class ProjectedTest : public ShadowTest {};

// Texels of this size are smaller than pixels, so that only pixels next to an edge may differ.
TEST_F(ProjectedTest, ShadowsArePlanarOnes) {
  for (const auto& [name, scene] :
       {std::pair{"sun", lit_by(sun())}, {"spot", lit_by(spot())}, {"lamp", lit_by(lamp())}}) {
    SCOPED_TRACE(name);
    const std::vector<float> planar = light(scene, settings_of("planar")),
                             picture = light(scene, settings_of("projected"));
    RenderPlan bright = settings_of("planar");
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

// Looks straight up at what is above a point.
Camera camera_below(const glm::dvec3& eye, double half) {
  Camera camera = camera_above({0, 0, 0}, half);
  camera.world_from_camera = {{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}, glm::dvec4(eye, 1)};
  return camera;
}

// Reverse projection: what is before the lamp would be thrown behind it as well.
TEST_F(ProjectedTest, NothingBehindTheProjectorIsChanged) {
  Scene scene = lit_by(lamp());
  add_instance(scene, add_mesh(scene, rectangle({0, 3, 0}, {3, 0, 0}, {0, 0, 3})));
  RenderPlan bright = settings_of("projected");
  bright.shadow_ambient = 1.0;
  EXPECT_NE(light(scene, settings_of("projected")), light(scene, bright)); // there are shadows on the floor
  scene.cameras.front() = camera_below({0, 2.5, 0}, 2.0);
  const std::vector<float> ceiling = light(scene, settings_of("projected"));
  EXPECT_EQ(ceiling, light(scene, bright));
  EXPECT_GT(*std::ranges::min_element(ceiling), 0.0f);
}

// What it is known to get wrong: a plane between the light and a caster is darkened by what is behind it.
TEST_F(ProjectedTest, PlanesBeforeCastersAreFalselyDark) {
  Scene scene = lit_by(sun());
  add_instance(scene, add_mesh(scene, rectangle({0, 2, 0}, {0, 0, 2}, {2, 0, 0})));
  scene.cameras.front() = camera_above({0, 0, 0}, 1.2);
  const std::vector<float> truth = light(scene, settings_of("traced"));
  EXPECT_GT(*std::ranges::min_element(truth), 0.0f); // nothing is above it
  EXPECT_EQ(false_fractions(truth, light(scene, settings_of("planar"))).total(), 0.0);
  EXPECT_GT(false_fractions(truth, light(scene, settings_of("projected"))).dark, 0.02);
}

class CookieTest : public ProjectedTest {
protected:
  ~CookieTest() override { std::filesystem::remove(path_); }

  // `value`: of the pixel in column x and row y.
  template <typename Value>
  RenderPlan with_cookie(std::uint32_t side, const Value& value) {
    Picture picture{.width = side, .height = side};
    for (const char* name : {"R", "G", "B"}) {
      Channel channel{.name = name};
      for (std::uint32_t i = 0; i < side * side; ++i) channel.values.push_back(value(i % side, i / side));
      picture.channels.push_back(channel);
    }
    write_picture(path_, picture, {}, {});
    RenderPlan settings = settings_of("projected");
    settings.shadow_cookie = path_;
    return settings;
  }

  const std::string path_ =
      (std::filesystem::temp_directory_path() / fmt::format("wavepath-cookie-{}.exr", ::getpid())).string();
};

TEST_F(CookieTest, OneValueEverywhereScalesTheLight) {
  const RenderPlan half = with_cookie(3, [](auto, auto) { return 0.5f; });
  for (const auto& [name, scene, fraction] :
       {std::tuple{"sun", lit_by(sun()), 0.5f}, {"spot", lit_by(spot()), 0.5f}, {"lamp", lit_by(lamp()), 1.0f}}) {
    SCOPED_TRACE(name);
    std::vector<float> expected = light(scene, settings_of("projected"));
    for (float& value : expected) value *= fraction;
    EXPECT_EQ(light(scene, half), expected);
  }
}

// Every pixel of the floor has the light that the cookie passes where it shows the pixel's point: over the square
// around a spot's cone, over the whole scene seen from a sun, upright.
TEST_F(CookieTest, CheckersLandWhereTheProjectionSays) {
  constexpr int kSide = 8;
  const auto checker = [](int x, int y) {
    return (std::clamp(x, 0, kSide - 1) / 2 + std::clamp(y, 0, kSide - 1)) % 2 ? 1.0f : 0.25f;
  };
  const RenderPlan settings = with_cookie(kSide, [&](auto x, auto y) { return checker(int(x), int(y)); });
  for (const PunctualLight& source : {sun(), spot()}) {
    const bool is_sun = source.kind == LightKind::directional;
    SCOPED_TRACE(is_sun ? "sun" : "spot");
    const Scene scene = lit_by(source);
    const glm::dvec3 forward = source.direction, right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0))),
                     up = glm::cross(right, forward);
    glm::dvec2 lo(-std::tan(source.outer_cone)), hi(-lo);
    for (int i = 0; is_sun && i < 8; ++i) {
      const glm::dvec3 corner(i & 1 ? 3 : -3, i & 2 ? 1 : 0, i & 4 ? 3 : -3);
      const glm::dvec2 at(glm::dot(right, corner), glm::dot(up, corner));
      lo = i == 0 ? at : glm::min(lo, at), hi = i == 0 ? at : glm::max(hi, at);
    }
    RenderPlan plain = settings_of("projected");
    plain.aovs = {"position"};
    const RenderResult whole = render(scene, plain);
    const std::vector<float> picture = light(scene, settings);
    const Picture& place = whole.picture;
    int checked = 0;
    for (std::size_t i = 0; i < picture.size(); ++i) {
      const glm::dvec3 p(channel(place, "P.X")[i], channel(place, "P.Y")[i], channel(place, "P.Z")[i]);
      if (!(place.channels[1].values[i] > 0.0f) || !(std::abs(p.y) < 1e-4)) continue;
      const glm::dvec3 from = is_sun ? p : p - source.position;
      const double depth = is_sun ? 1.0 : glm::dot(forward, from);
      const glm::dvec2 at = (glm::dvec2(glm::dot(right, from), glm::dot(up, from)) / depth - lo) / (hi - lo);
      const glm::dvec2 texel = glm::dvec2(at.x, 1.0 - at.y) * double(kSide) - 0.5, corner = glm::floor(texel);
      const int x = int(corner.x), y = int(corner.y);
      const double expected =
          glm::mix(glm::mix(checker(x, y), checker(x + 1, y), texel.x - corner.x),
                   glm::mix(checker(x, y + 1), checker(x + 1, y + 1), texel.x - corner.x), texel.y - corner.y);
      EXPECT_NEAR(picture[i] / place.channels[1].values[i], expected, 0.02) << p.x << " " << p.z;
      ++checked;
    }
    EXPECT_GT(checked, 500);
  }
}

// Two pictures of one name are two renders: neither is resumed with the other, nor merged.
TEST_F(CookieTest, CountsByItsContents) {
  const auto identity = [this](float value) {
    return identity_of(1, View{}, with_cookie(2, [value](auto, auto) { return value; }));
  };
  const std::string half = identity(0.5f);
  EXPECT_NE(identity(0.25f), half);
  EXPECT_EQ(identity(0.5f), half);
  EXPECT_EQ(half.find(path_), std::string::npos); // the same picture may lie elsewhere
}

TEST_F(CookieTest, RefusesWhatIsNoCookie) {
  RenderPlan settings = with_cookie(2, [](auto, auto) { return 1.0f; });
  settings.shadows = index_of(kShadowTechniques.names(), "map");
  EXPECT_THROW(check_shadow_settings(settings), UsageError);
  EXPECT_THROW(render(lit_by(sun()), with_cookie(2, [](auto, auto) { return -1.0f; })), Error);
  settings = settings_of("projected");
  settings.shadow_cookie = "/nowhere/cookie.exr";
  EXPECT_THROW(render(lit_by(sun()), settings), Error);
  EXPECT_THROW(render(lit_by_square(), settings_of("projected")), Error);
}

} // namespace
} // namespace wavepath::test
