// Planar shadows: on the scene's large planes they are the traced ones, but for what a rasterizer snaps at their edges;
// everywhere else there are none.
#include "tests/shadow_scene.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/shadows/catalogue.h"
#include "host/integrators/hybrid/shadows/receiver_planes.h"
#include "host/picture/files/picture_io.h"

namespace wavepath::test {
namespace {

constexpr int kWidth = 96, kHeight = 72;

bool is_on_floor(const glm::vec3& p) { return std::abs(p.y) < 1e-4f; }

RenderPlan planar_settings(std::string_view technique = "planar") {
  RenderPlan settings = shadow_settings(technique);
  settings.aovs = {"position", "depth"};
  return settings;
}

const std::vector<float>& channel(const RenderResult& result, const char* name) {
  return find_channel(result.picture, name)->values;
}

// The point that every pixel shows; not a number where there is none.
std::vector<glm::vec3> seen(const RenderResult& result) {
  const std::vector<float>&x = channel(result, "P.X"), &y = channel(result, "P.Y"), &z = channel(result, "P.Z");
  std::vector<glm::vec3> points(x.size(), glm::vec3(NAN));
  for (std::size_t i = 0; i < x.size(); ++i)
    if (channel(result, "Z")[i] < 1e9f) points[i] = {x[i], y[i], z[i]};
  return points;
}

class PlanarTest : public ShadowTest {
protected:
  // Where `receives`, light is the traced light but within a pixel of an edge of its shadow, and there for a few pixels
  // only. Elsewhere it is the light without any shadow.
  template <typename Receives>
  void expect_traced_on_planes(const Scene& scene, const Receives& receives, double most = 0.1) {
    RenderPlan bright = planar_settings();
    bright.shadow_ambient = 1.0;
    const RenderResult traced = render(scene, planar_settings("traced"));
    const std::vector<glm::vec3> points = seen(traced);
    const std::vector<float>& truth = traced.picture.channels[1].values;
    const std::vector<float> picture = light(scene, planar_settings()), unshadowed = light(scene, bright);
    int dark = 0, wrong = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const int i = y * kWidth + x;
        if (!receives(points[i])) {
          EXPECT_EQ(picture[i], unshadowed[i]) << x << " " << y;
          continue;
        }
        dark += truth[i] < unshadowed[i];
        if (truth[i] == picture[i]) continue;
        ++wrong;
        bool is_edge = false;
        for (int v = std::max(y - 1, 0); v <= std::min(y + 1, kHeight - 1); ++v)
          for (int u = std::max(x - 1, 0); u <= std::min(x + 1, kWidth - 1); ++u) {
            const int j = v * kWidth + u;
            is_edge |= receives(points[j]) && (truth[j] < unshadowed[j]) != (truth[i] < unshadowed[i]);
          }
        EXPECT_TRUE(is_edge) << x << " " << y << ": " << truth[i] << " " << picture[i];
      }
    EXPECT_GT(dark, 100);
    EXPECT_LE(wrong, most / 100.0 * kWidth * kHeight);
    RecordProperty("wrong", wrong);
  }
};

TEST_F(PlanarTest, ShadowsOnTheFloorAreTracedOnes) {
  for (const auto& [name, scene] :
       {std::pair{"sun", lit_by(sun())}, {"spot", lit_by(spot())}, {"lamp", lit_by(lamp())}}) {
    SCOPED_TRACE(name);
    expect_traced_on_planes(scene, is_on_floor);
  }
}

TEST_F(PlanarTest, OrthographicCamerasSeeThem) {
  for (const auto& [name, light] : {std::pair{"sun", sun()}, {"lamp", lamp()}}) {
    SCOPED_TRACE(name);
    Scene scene = lit_by(light);
    scene.cameras.front().orthographic = true;
    scene.cameras.front().xmag = 2.4, scene.cameras.front().ymag = 1.8;
    expect_traced_on_planes(scene, is_on_floor);
  }
}

TEST_F(PlanarTest, SeveralLightsAndPlanes) {
  Scene scene = bodies();
  add_instance(scene, add_mesh(scene, rectangle({0, 1.5f, -1.2f}, {3, 0, 0}, {0, 1.5f, 0})));
  for (const PunctualLight& light : {sun({0.1, -0.8, -0.6}), spot({0.5, 2.0, 1.5}), lamp({-0.4, 1.6, 1.2})})
    scene.lights.push_back(light);
  const auto on_planes = [](const glm::vec3& p) { return is_on_floor(p) || std::abs(p.z + 1.2f) < 1e-4f; };
  expect_traced_on_planes(scene, on_planes, 0.2);
}

// A sheet that is all hole is no caster, for the technique as for rays.
TEST_F(PlanarTest, PlacedAndTurnedCastersCountAndHolesDoNot) {
  Scene scene = lit_by(sun());
  const std::uint32_t mesh = add_mesh(scene, box({0, 0, 0}, {0.1f, 0.1f, 0.1f}));
  for (int i = 0; i < 12; ++i) {
    const double turn = 0.7 * i, mirror = i % 2 ? -1.0 : 1.0;
    add_instance(scene, mesh,
                 {{mirror * std::cos(turn), 0, -std::sin(turn), 0},
                  {0, 1.0 + 0.1 * i, 0, 0},
                  {mirror * std::sin(turn), 0, std::cos(turn), 0},
                  {1.5 * std::cos(2.4 * i), 0.4 + 0.02 * i, 1.5 * std::sin(2.4 * i), 1}});
  }
  Material holes = plain_material();
  holes.base_color = {0.5f, 0.5f, 0.5f, 0.3f}; // below the cutoff
  holes.alpha_mode = AlphaMode::mask;
  scene.materials.push_back(holes);
  add_instance(scene, add_mesh(scene, rectangle({0.0f, 0.6f, 0.9f}, {0, 0, 0.4f}, {0.4f, 0, 0}), 1));
  expect_traced_on_planes(scene, is_on_floor, 0.2);
}

// What the technique is known to get wrong: bodies are no planes, so they take no shadow, of others or of themselves.
TEST_F(PlanarTest, WhatIsOnNoPlaneStaysLit) {
  Scene scene = lit_by(sun());
  add_instance(scene, add_mesh(scene, rectangle({-0.5f, 1.5f, 0.0f}, {0, 0, 0.2f}, {0.2f, 0, 0}))); // above a box
  const RenderResult traced = render(scene, planar_settings("traced"));
  const std::vector<glm::vec3> points = seen(traced);
  const std::vector<float>& truth = traced.picture.channels[1].values;
  const std::vector<float> picture = light(scene, planar_settings());
  int falsely_lit = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    falsely_lit += !is_on_floor(points[i]) && truth[i] == 0.0f && picture[i] > 0.0f;
  EXPECT_GT(falsely_lit, 20);
}

// The textbook's antishadow: a caster beyond the light would be flattened through it.
TEST_F(PlanarTest, NothingBeyondTheLightCasts) {
  Scene scene = lit_by(lamp());
  const std::vector<float> without = light(scene, planar_settings());
  add_instance(scene, add_mesh(scene, box({-1.4f, 2.6f, -1.0f}, {0.2f, 0.2f, 0.2f})));
  EXPECT_EQ(false_fractions(without, light(scene, planar_settings())).total(), 0.0);
  // One around the light casts with what is below it.
  add_instance(scene, add_mesh(scene, rectangle({-0.9f, 1.6f, -0.5f}, {0, 0.9f, 0}, {0.1f, 0, -0.1f})));
  expect_traced_on_planes(scene, is_on_floor);
}

// Its false shadow: a caster beneath the plane would be flattened upwards.
TEST_F(PlanarTest, NothingBeneathThePlaneCasts) {
  for (const PunctualLight& source : {sun(), lamp()}) {
    Scene scene = lit_by(source);
    const std::vector<float> without = light(scene, planar_settings());
    add_instance(scene, add_mesh(scene, box({0.3f, -0.6f, 0.9f}, {0.3f, 0.3f, 0.3f})));
    EXPECT_EQ(false_fractions(without, light(scene, planar_settings())).total(), 0.0);
    // What goes through the plane casts with its upper part.
    add_instance(scene, add_mesh(scene, box({0.3f, 0.0f, 0.9f}, {0.1f, 0.4f, 0.1f})));
    expect_traced_on_planes(scene, is_on_floor);
  }
}

TEST_F(PlanarTest, SameBitsHoweverTheWorkIsCut) {
  RenderPlan settings = planar_settings();
  settings.last_sample = 3;
  settings.shadow_samples = 2;
  const std::vector<float> whole = light(lit_by(lamp()), settings);
  settings.wave_slots = 1024;
  EXPECT_EQ(light(lit_by(lamp()), settings), whole);
}

TEST_F(PlanarTest, LargePlanesReceive) {
  const auto planes_of = [](Scene scene) { return receiver_planes(pack(scene, {.direct = gpu::kDirectNee})); };
  Scene scene = lit_by(sun());
  std::vector<ReceiverPlane> planes = planes_of(scene);
  ASSERT_EQ(planes.size(), 1u);
  // The floor and the underside of the box on it.
  EXPECT_NEAR(planes[0].area, 36.36, 1e-4);
  EXPECT_NEAR(std::abs(planes[0].normal.y), 1.0, 1e-6);
  // Pieces count together, whichever way they face; what is a little higher does not.
  for (const float x : {-4.0f, 4.0f})
    add_instance(scene, add_mesh(scene, rectangle({x, 0, 0}, {0, 0, x / 4}, {0.5f, 0, 0})));
  add_instance(scene, add_mesh(scene, rectangle({0, 0.01f, 5}, {0, 0, 1}, {1, 0, 0})));
  planes = planes_of(scene);
  ASSERT_EQ(planes.size(), 2u);
  EXPECT_NEAR(planes[0].area, 40.36, 1e-4);
  EXPECT_NEAR(planes[1].area, 4.0, 1e-4);
}

TEST_F(PlanarTest, RefusesLampsWithAnExtent) {
  EXPECT_THROW(render(lit_by_square(), planar_settings()), Error);
  EXPECT_THROW(check_shadow_settings(shadow_settings("planar", 256)), UsageError); // there is no map
}

TEST_F(PlanarTest, RefusesScenesWithoutPlanes) {
  Scene scene;
  scene.materials.push_back(plain_material());
  add_instance(scene, add_mesh(scene, ball({0, 0, 0}, 0.5f)));
  scene.lights.push_back(sun());
  const PackedScene packed = pack(scene, {.direct = gpu::kDirectNee});
  EXPECT_NE(unsupported_reason(*kShadowTechniques.find(planar_settings()), packed).find("large planes"),
            std::string::npos);
  EXPECT_EQ(unsupported_reason(*kShadowTechniques.find(planar_settings("projected")), packed),
            ""); // whose cookies shine on everything
}

} // namespace
} // namespace wavepath::test
