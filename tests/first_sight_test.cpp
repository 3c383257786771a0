// What a scene without lights or camera looks like at first sight: default light, built-in environments, framing of
// objects and of interiors, exposure, ground.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/picture/exposure.h"
#include "host/picture/files/picture_io.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/environment_light.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/default_light.h"
#include "host/scene/staging/environment.h"
#include "host/scene/staging/environment_sky.h"
#include "host/scene/staging/environment_studio.h"
#include "host/scene/staging/ground.h"
#include "host/scene/staging/interior.h"
#include "host/scene/staging/view.h"
#include "kernels/base/features.h"
#include "tests/scene_builder.h"
#include "tests/temporary_folder.h"

namespace wavepath::test {
namespace {

constexpr double kPi = std::numbers::pi;

double luminance(const glm::dvec3& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

// ---- The rule

Scene with_material(const Material& material, bool camera) {
  Scene scene = triangle_scene();
  scene.materials[0] = material;
  if (camera) scene.cameras.emplace_back();
  return scene;
}

Material shining(float radiance, bool textured = false) {
  Material material = plain_material();
  material.emission = glm::vec3(0.0f, radiance, 0.0f);
  if (textured) material.emission_texture.image = 0;
  return material;
}

Scene with_lamp(bool camera) {
  Scene scene = with_material(plain_material(), camera);
  scene.lights.emplace_back();
  return scene;
}

TEST(DefaultLight, IsAuthoredWhereSomebodyLitAndFramedTheScene) {
  Scene interior = with_lamp(true);
  EXPECT_EQ(choose_light(interior, {}), DefaultLight::authored);
  EXPECT_EQ(choose_light(interior, Standpoint{}), DefaultLight::authored);
  EXPECT_EQ(choose_light(with_material(shining(0.5f), true), {}), DefaultLight::authored);
  EXPECT_EQ(choose_light(with_material(shining(4.0f, true), true), {}), DefaultLight::authored);
}

TEST(DefaultLight, LightsTheAssetBesidesItsOwnLights) {
  const Scene scene = with_lamp(false);
  EXPECT_EQ(choose_light(scene, {}), DefaultLight::studio_besides);
  EXPECT_EQ(environment_name(DefaultLight::studio_besides), "studio");
  EXPECT_NE(reason(DefaultLight::studio_besides).find("besides its own lights"), std::string_view::npos);
  EXPECT_EQ(choose_light(scene, Standpoint{}), DefaultLight::sky_besides);
  EXPECT_EQ(environment_name(DefaultLight::sky_besides), "sky");
  Standpoint closed;
  closed.lamp = glm::dvec3(0.0);
  EXPECT_EQ(choose_light(scene, closed), DefaultLight::authored) << "no sky reaches it";
  EXPECT_TRUE(is_lit(scene));
  EXPECT_FALSE(is_lit(with_material(shining(4.0f), false)));
}

TEST(DefaultLight, IsTheStudioForAssets) {
  EXPECT_EQ(choose_light(triangle_scene(), {}), DefaultLight::studio);
  EXPECT_EQ(choose_light(with_material(plain_material(), true), {}), DefaultLight::studio);
  EXPECT_EQ(choose_light(with_material(shining(4.0f), false), {}), DefaultLight::studio) << "no camera";
  EXPECT_EQ(choose_light(with_material(shining(1.0f, true), true), {}), DefaultLight::studio) << "a display";
  Material unlit = shining(4.0f);
  unlit.unlit = true;
  EXPECT_EQ(choose_light(with_material(unlit, true), {}), DefaultLight::studio);
  Scene unused = with_material(plain_material(), true);
  unused.materials.push_back(shining(4.0f));
  EXPECT_EQ(choose_light(unused, {}), DefaultLight::studio);
  Scene dark = triangle_scene();
  dark.lights.emplace_back().intensity = glm::vec3(0.0f);
  EXPECT_EQ(choose_light(dark, {}), DefaultLight::studio);
}

TEST(DefaultLight, IsTheSkyForInteriorsAndALampForClosedOnes) {
  Standpoint inside;
  EXPECT_EQ(choose_light(triangle_scene(), inside), DefaultLight::sky);
  inside.lamp = glm::dvec3(1, 2, 3);
  inside.lamp_height = 2.0;
  EXPECT_EQ(choose_light(triangle_scene(), inside), DefaultLight::lamp);
  EXPECT_EQ(room_lamp(inside).position, glm::dvec3(1, 2, 3));
  EXPECT_NEAR(room_lamp(inside).intensity.g / 4.0 / kPi, 1.0, 1e-6); // lux over pi: of a white floor below
}

// ---- Environments

TEST(BuiltinEnvironments, AreFoundByName) {
  EXPECT_EQ(load_environment("black").radiance, glm::vec3(0.0f));
  EXPECT_EQ(load_environment("white", 2.0).radiance, glm::vec3(2.0f));
  const Environment studio = load_environment("studio", 3.0, 0.5);
  EXPECT_EQ(studio.radiance, glm::vec3(3.0f));
  EXPECT_EQ(studio.rotation, 0.5);
  EXPECT_EQ(studio.map, studio_environment().map);
  EXPECT_EQ(load_environment("sky").map, sky_environment().map);
}

TEST(BuiltinEnvironments, LightAWhiteFloorToRadianceOne) {
  for (const Environment& map : {studio_environment(), sky_environment()}) {
    EXPECT_NEAR(luminance(floor_irradiance(map)), kPi, 1e-3);
    for (const glm::vec3& texel : map.map)
      ASSERT_TRUE(std::isfinite(texel.x + texel.y + texel.z) && std::min({texel.x, texel.y, texel.z}) >= 0.0f);
  }
}

TEST(BuiltinEnvironments, TheStudioIsNeutralAndLitFromTheFrontLeft) {
  const Environment studio = studio_environment();
  double left = 0.0, right = 0.0, brightest = 0.0;
  glm::dvec3 key(0.0);
  for (std::size_t y = 0; y < studio.height; ++y)
    for (std::size_t x = 0; x < studio.width; ++x) {
      const glm::vec3 texel = studio.map[y * studio.width + x];
      ASSERT_EQ(texel.r, texel.g);
      ASSERT_EQ(texel.g, texel.b);
      const glm::dvec3 d = environment_direction(
          {(static_cast<double>(x) + 0.5) / studio.width, (static_cast<double>(y) + 0.5) / studio.height}, 0.0);
      (d.x < 0.0 ? left : right) += texel.r * texel_solid_angle(y, studio.width, studio.height);
      if (texel.r > brightest) brightest = texel.r, key = d;
    }
  EXPECT_GT(left, 1.5 * right);
  EXPECT_LT(key.x, -0.3);
  EXPECT_GT(key.y, 0.3);
  EXPECT_GT(key.z, 0.3);
}

// The sun brings what the air lets through, wherever its disc falls among the texels.
TEST(BuiltinEnvironments, TheSunIsADiscOfItsTrueSizeWithAllItsLight) {
  const Environment sky = sky_environment();
  const glm::dvec3 sun(-std::sin(kSunAzimuth) * std::cos(kSunElevation), std::sin(kSunElevation),
                       std::cos(kSunAzimuth) * std::cos(kSunElevation));
  double near_sun = 0.0, elsewhere = 0.0, disc = 0.0, brightest = 0.0;
  const double disc_solid_angle = 2.0 * kPi * (1.0 - std::cos(kSunRadius));
  for (const glm::vec3& texel : sky.map) brightest = std::max(brightest, luminance(texel));
  for (std::size_t y = 0; y < sky.height / 2; ++y)
    for (std::size_t x = 0; x < sky.width; ++x) {
      const glm::dvec3 d = environment_direction(
          {(static_cast<double>(x) + 0.5) / sky.width, (static_cast<double>(y) + 0.5) / sky.height}, 0.0);
      const double angle = std::atan2(glm::length(glm::cross(d, sun)), glm::dot(d, sun));
      const double solid_angle = texel_solid_angle(y, sky.width, sky.height);
      const double light = luminance(sky.map[y * sky.width + x]) * solid_angle;
      (angle < 2.0 * kSunRadius ? near_sun : elsewhere) += light * d.y;
      if (luminance(sky.map[y * sky.width + x]) > 0.5 * brightest) disc += solid_angle;
    }
  EXPECT_NEAR(near_sun / kSunRadius / kSunRadius, brightest * kPi * sun.y, 0.03 * brightest * kPi * sun.y);
  EXPECT_NEAR(disc, disc_solid_angle, 0.25 * disc_solid_angle); // in whole texels
  EXPECT_NEAR(near_sun / (near_sun + elsewhere), 0.65, 0.01);   // 51 of 79 klx on level ground
}

TEST(BuiltinEnvironments, AreImportanceSampled) {
  for (const Environment& map : {studio_environment(), sky_environment()}) {
    PackedScene packed;
    pack_environment(map, gpu::kDirectNee, packed);
    ASSERT_EQ(packed.environment.size(), map.map.size());
    double from_bright = 0.0, bright_solid_angle = 0.0;
    for (std::size_t i = 0; i < map.map.size(); ++i)
      if (map.map[i].g > 3.0f) {
        from_bright += packed.environment[i].w;
        bright_solid_angle += texel_solid_angle(i / map.width, map.width, map.height) / (4.0 * kPi);
      }
    EXPECT_GT(from_bright, 5.0 * bright_solid_angle);
  }
}

// ---- Framing

// How far the scene's vertices reach in the picture, in half pictures.
struct Reach {
  double left = 1e300, right = -1e300, bottom = 1e300, top = -1e300;
  double most() const { return std::max({-left, right, -bottom, top}); }
};

Reach reach_of(const Scene& scene, const View& view) {
  Reach reach;
  for (const Instance& instance : scene.instances)
    for (const std::uint32_t index : scene.meshes[instance.mesh].indices) {
      const glm::dvec3 p =
          transform_point(instance.world_from_object, scene.meshes[instance.mesh].positions[index]) - view.position;
      const double depth = glm::dot(p, view.forward);
      EXPECT_GT(depth, 0.0);
      const double x = glm::dot(p, view.right) / glm::dot(view.right, view.right) / depth,
                   y = glm::dot(p, view.up) / glm::dot(view.up, view.up) / depth;
      reach.left = std::min(reach.left, x), reach.right = std::max(reach.right, x);
      reach.bottom = std::min(reach.bottom, y), reach.top = std::max(reach.top, y);
    }
  return reach;
}

// A closed box around zero with corners at +-half; its faces look outwards, or inwards.
std::vector<glm::vec3> box(const glm::vec3& half, bool inwards = false) {
  std::vector<glm::vec3> corners;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      glm::vec3 p[4];
      const float us[4] = {-1, 1, 1, -1}, vs[4] = {-1, -1, 1, 1};
      for (int k = 0; k < 4; ++k) {
        const int from = (side > 0.0f) != inwards ? k : 3 - k;
        p[k][axis] = side * half[axis], p[k][u] = us[from] * half[u], p[k][v] = vs[from] * half[v];
      }
      for (const int k : {0, 1, 2, 0, 2, 3}) corners.push_back(p[k]);
    }
  return corners;
}

std::vector<glm::vec3> ball(float radius, bool inwards = false, float lowest = -1.0f) {
  constexpr int kAround = 24, kRings = 12;
  std::vector<glm::vec3> corners;
  const auto at = [&](int ring, int around) {
    const double polar = kPi * ring / kRings, phi = 2.0 * kPi * around / kAround;
    return radius * glm::vec3(std::sin(polar) * std::sin(phi), std::cos(polar), std::sin(polar) * std::cos(phi));
  };
  for (int ring = 0; ring < kRings; ++ring)
    for (int around = 0; around < kAround; ++around) {
      const glm::vec3 a = at(ring, around), b = at(ring + 1, around), c = at(ring + 1, around + 1),
                      d = at(ring, around + 1);
      if (b.y < lowest * radius) continue;
      for (const glm::vec3& p : {a, b, c, a, c, d}) corners.push_back(p);
      if (inwards)
        for (std::size_t t = corners.size() - 6; t < corners.size(); t += 3) std::swap(corners[t + 1], corners[t + 2]);
    }
  return corners;
}

Scene scene_of(const std::vector<std::vector<glm::vec3>>& meshes, const glm::dmat4& transform = glm::dmat4(1.0)) {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  for (const std::vector<glm::vec3>& mesh : meshes) add_instance(scene, add_mesh(scene, mesh), transform);
  return scene;
}

std::vector<Scene> assets() {
  const auto moved = glm::translate(glm::dmat4(1.0), glm::dvec3(1e6, -2e5, 3e5));
  const auto turned = glm::rotate(glm::scale(glm::dmat4(1.0), glm::dvec3(1e-4)), 0.7, glm::dvec3(1, 2, 3));
  std::vector<Scene> scenes = {triangle_scene(),
                               scene_of({box({1, 1, 1})}),
                               scene_of({box({10, 0.1f, 0.1f})}),
                               scene_of({box({0.1f, 10, 0.1f})}, turned),
                               scene_of({box({0.1f, 0.1f, 10})}),
                               scene_of({ball(1.0f)}, moved),
                               scene_of({ball(1.0f), box({0.2f, 3, 0.2f})}, turned)};
  Scene crowd = scene_of({ball(1.0f)});
  for (int i = 1; i < 20; ++i)
    add_instance(crowd, 0, glm::translate(glm::dmat4(1.0), glm::dvec3(3 * i, 0.1 * i * i, -2 * (i % 3))));
  scenes.push_back(crowd);
  for (const char* file : {"showcase.glb", "cornell_box.gltf", "rooms/hundred_lights.glb"}) {
    Scene scene = load_gltf(std::string(WAVEPATH_SOURCE_DIR "/scenes/") + file);
    scene.cameras.clear();
    scenes.push_back(scene);
  }
  return scenes;
}

TEST(Framing, ObjectsFillTheirFractionOfThePictureAndAreInItsMiddle) {
  for (const Scene& scene : assets()) {
    const Framing framing = find_framing(scene, false);
    for (const auto& [width, height] : {std::pair{1280u, 720u}, std::pair{300u, 100u}, std::pair{100u, 300u}}) {
      const View view = resolve_view(scene, framing, {}, width, height);
      const Reach reach = reach_of(scene, view);
      EXPECT_NEAR(reach.most(), kFramedFraction, 1e-6) << scene.path << width << "x" << height;
      EXPECT_NEAR(reach.left, -reach.right, 1e-6);
      EXPECT_NEAR(reach.bottom, -reach.top, 1e-6);
      EXPECT_NEAR(view.right.y, 0.0, 1e-12) << "level";
      EXPECT_LT(view.forward.z, -0.8) << "from the front";
      EXPECT_LT(view.forward.x, -0.3) << "and its right";
      EXPECT_LT(view.forward.y, 0.0);
    }
  }
}

TEST(Framing, AWiderAngleFillsThePictureAsWell) {
  const Scene scene = scene_of({ball(1.0f)});
  const View view = resolve_view(scene, {.yfov = 1.5}, 100, 100);
  EXPECT_NEAR(glm::length(view.up), std::tan(0.75), 1e-12);
  EXPECT_NEAR(reach_of(scene, view).most(), kFramedFraction, 1e-6);
}

TEST(Framing, OfPointsAndNothingIsFinite) {
  const Scene point = scene_of({{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}});
  for (const Scene& scene : {Scene{}, point}) {
    const View view = resolve_view(scene, {}, 100, 50);
    EXPECT_TRUE(finite_point(view.position));
    EXPECT_GT(glm::length(view.position - world_bounds(scene).centre()), 1e-3);
  }
}

// ---- Interiors

// 8 x 3 x 5 metres, its floor at zero, without one pane of its right wall.
Scene room(const glm::dmat4& transform = glm::dmat4(1.0)) {
  std::vector<glm::vec3> walls = box({4.0f, 1.5f, 2.5f}, true);
  const auto in_right_wall = [](const glm::vec3& p) { return p.z > 2.4f; };
  for (std::size_t t = 0; t < walls.size(); t += 3)
    if (in_right_wall(walls[t]) && in_right_wall(walls[t + 1]) && in_right_wall(walls[t + 2])) {
      walls.erase(walls.begin() + static_cast<std::ptrdiff_t>(t), walls.begin() + static_cast<std::ptrdiff_t>(t) + 6);
      break;
    }
  // The wall again, but for a window 2 metres wide and 1 high.
  const auto pane = [&](float x0, float x1, float y0, float y1) {
    const glm::vec3 a(x0, y0, 2.5f), b(x1, y0, 2.5f), c(x1, y1, 2.5f), d(x0, y1, 2.5f);
    for (const glm::vec3& p : {a, c, b, a, d, c}) walls.push_back(p);
  };
  pane(-4, -1, -1.5f, 1.5f), pane(1, 4, -1.5f, 1.5f), pane(-1, 1, -1.5f, -0.5f), pane(-1, 1, 0.5f, 1.5f);
  return scene_of({walls}, transform * glm::translate(glm::dmat4(1.0), glm::dvec3(0, 1.5, 0)));
}

TEST(Interior, TheCameraStandsInARoomAndLooksAlongIt) {
  const Scene scene = room();
  const Framing framing = find_framing(scene);
  ASSERT_TRUE(framing.inside);
  const View view = resolve_view(scene, framing, {}, 160, 90);
  EXPECT_NEAR(view.position.y, 1.6, 1e-6);
  EXPECT_LT(std::abs(view.position.x), 4.0);
  EXPECT_LT(std::abs(view.position.z), 2.5);
  EXPECT_GT(std::abs(view.forward.x), 0.8) << "along the longer side";
  EXPECT_LT(view.position.x * view.forward.x, 0.0) << "with the way before it";
  EXPECT_EQ(view.forward.y, 0.0);
}

TEST(Interior, AClosedRoomHasAPositionForALamp) {
  EXPECT_FALSE(find_framing(room()).inside->lamp);
  const Scene closed = scene_of({box({4.0f, 1.5f, 2.5f}, true)}); // its floor at -1.5
  const Standpoint inside = find_framing(closed).inside.value();
  ASSERT_TRUE(inside.lamp);
  EXPECT_NEAR(inside.lamp->y, 0.1 + 0.8 * 1.4, 1e-6); // the eye at 1.6 over the floor, the ceiling 1.4 above it
  EXPECT_NEAR(inside.lamp_height, inside.lamp->y + 1.5, 1e-6);
  EXPECT_LT(std::abs(inside.lamp->x), 4.0);
  EXPECT_LT(std::abs(inside.lamp->z), 2.5);
}

TEST(Interior, IsFoundAtAnyScaleAndAgain) {
  const Scene metres = room(), millimetres = room(glm::scale(glm::dmat4(1.0), glm::dvec3(1000.0)));
  const Standpoint here = find_framing(metres).inside.value(), there = find_framing(millimetres).inside.value();
  EXPECT_NEAR(there.eye.y, 0.6 * 3000.0, 1e-2);
  EXPECT_NEAR(there.eye.x, 1000.0 * here.eye.x, 1e-2);
  EXPECT_NEAR(there.eye.z, 1000.0 * here.eye.z, 1e-2);
  const Standpoint again = find_framing(metres).inside.value();
  EXPECT_EQ(again.eye, here.eye);
  EXPECT_EQ(again.target, here.target);
}

TEST(Interior, ObjectsAreNone) {
  const std::vector<glm::vec3> shell = ball(1.0f), lining = ball(0.9f, true);
  const std::vector<std::pair<const char*, Scene>> objects = {
      {"triangle", triangle_scene()},
      {"box", scene_of({box({1, 1, 1})})},
      {"mirrored box", scene_of({box({1, 1, 1})}, glm::scale(glm::dmat4(1.0), glm::dvec3(-1, 1, 1)))},
      {"ball", scene_of({shell})},
      {"helmet", scene_of({ball(1.0f, false, -0.4f), ball(0.9f, true, -0.4f)})},
  };
  for (const auto& [name, scene] : objects) EXPECT_FALSE(find_framing(scene).inside) << name;
  Scene glass = room();
  glass.materials[0].transmission = 1.0f;
  EXPECT_FALSE(find_framing(glass).inside) << "what is seen through is no wall";
}

TEST(Interior, OurRoomsAre) {
  for (const char* file : {"door_ajar.glb", "glazed_room.glb", "slit_room.glb"}) {
    Scene scene = load_gltf(std::string(WAVEPATH_SOURCE_DIR "/scenes/rooms/") + file);
    scene.cameras.clear();
    EXPECT_TRUE(find_framing(scene).inside) << file;
  }
  for (const char* file : {"showcase.glb", "cornell_box.gltf", "furnace_metal.gltf"}) {
    Scene scene = load_gltf(std::string(WAVEPATH_SOURCE_DIR "/scenes/") + file);
    EXPECT_FALSE(find_framing(scene).inside) << file;
  }
}

// ---- Exposure

Picture flat_picture(float value, std::uint32_t width = 40, std::uint32_t height = 30) {
  Picture picture{width, height, {}};
  for (const char* name : {"R", "G", "B"})
    picture.channels.push_back({name, std::vector<float>(std::size_t{width} * height, value)});
  picture.channels.push_back({"A", std::vector<float>(std::size_t{width} * height, 1.0f)});
  return picture;
}

void fill(Picture& picture, std::size_t first, std::size_t last, float value) {
  for (std::size_t c = 0; c < 3; ++c)
    std::fill(picture.channels[c].values.begin() + static_cast<std::ptrdiff_t>(first),
              picture.channels[c].values.begin() + static_cast<std::ptrdiff_t>(last), value);
}

TEST(AutoExposure, BringsAnEvenPictureToTheMiddle) {
  EXPECT_EQ(auto_exposure(flat_picture(static_cast<float>(kMiddle))), 0.0);
  EXPECT_EQ(auto_exposure(flat_picture(static_cast<float>(kMiddle / 8.0))), 3.0);
  EXPECT_EQ(auto_exposure(flat_picture(static_cast<float>(kMiddle * 1024.0))), -10.0);
  EXPECT_EQ(auto_exposure(flat_picture(1.0f)), std::round(100.0 * std::log2(kMiddle)) / 100.0);
  EXPECT_EQ(auto_exposure(flat_picture(0.0f)), 0.0);
  EXPECT_EQ(auto_exposure(flat_picture(static_cast<float>(kMiddle), 1920, 1080)), 0.0);
}

TEST(AutoExposure, AveragesLogarithms) {
  Picture picture = flat_picture(0.1f);
  fill(picture, 0, 600, 0.4f); // half of it
  EXPECT_NEAR(auto_exposure(picture), std::log2(kMiddle / 0.2), 0.005);
  fill(picture, 0, 600, 0.0f); // is nothing
  EXPECT_NEAR(auto_exposure(picture), std::log2(kMiddle / 0.1), 0.005);
}

TEST(AutoExposure, KeepsHighlights) {
  Picture picture = flat_picture(0.01f);
  fill(picture, 0, 120, 2.0f); // a tenth
  EXPECT_NEAR(auto_exposure(picture), std::log2(kBright / 2.0), 0.005);
  picture = flat_picture(0.01f);
  fill(picture, 0, 40, 2.0f); // a thirtieth, as of a lamp, may burn out
  EXPECT_GT(auto_exposure(picture), 3.0);
}

TEST(AutoExposure, IsNotMovedByOddValues) {
  Picture picture = flat_picture(0.2f, 1920, 1080);
  const double before = auto_exposure(picture);
  picture.channels[0].values[5] = std::numeric_limits<float>::quiet_NaN();
  picture.channels[1].values[6] = std::numeric_limits<float>::infinity();
  picture.channels[2].values[7] = -1e30f;
  picture.channels[1].values[90000] = 1e4f; // a firefly
  EXPECT_NEAR(auto_exposure(picture), before, 0.02);
}

// Whatever is printed gives the same file.
TEST(AutoExposure, ItsValueGivesTheSameFile) {
  const TemporaryFolder folder;
  Picture picture = flat_picture(0.7f);
  for (std::size_t i = 0; i < 1200; ++i) picture.channels[i % 3].values[i] *= static_cast<float>(i % 17) / 5.0f;
  write_picture(folder.file("auto.png"), picture, {}, {.exposure = std::nullopt});
  write_picture(folder.file("value.png"), picture, {}, {.exposure = auto_exposure(picture)});
  write_picture(folder.file("none.png"), picture, {}, {});
  const auto contents = [&](const char* name) {
    std::ifstream file(folder.file(name), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  EXPECT_EQ(contents("auto.png"), contents("value.png"));
  EXPECT_NE(contents("auto.png"), contents("none.png"));
}

// ---- Ground

TEST(Ground, LiesUnderTheLowestPointAndFadesOut) {
  Scene scene = scene_of({ball(2.0f)}, glm::translate(glm::dmat4(1.0), glm::dvec3(5, 7, 9)));
  scene.environment = studio_environment();
  const Bounds before = world_bounds(scene);
  add_ground(scene, before);
  ASSERT_EQ(scene.meshes.size(), 2u);
  const Bounds disc = mesh_bounds(scene.meshes[1], scene.instances[1].world_from_object);
  EXPECT_LT(disc.hi.y, before.lo.y);
  EXPECT_GT(disc.hi.y, before.lo.y - 1e-3 * before.radius());
  EXPECT_GT(disc.hi.x - disc.lo.x, 3.0 * (before.hi.x - before.lo.x));
  EXPECT_NEAR(disc.centre().x, 5.0, 1e-6);
  EXPECT_NEAR(disc.centre().z, 9.0, 1e-6);
  const Mesh& mesh = scene.meshes[1];
  EXPECT_EQ(mesh.colors.front().a, 1.0f);
  EXPECT_EQ(mesh.colors.back().a, 0.0f);
  EXPECT_EQ(scene.materials.back().alpha_mode, AlphaMode::blend);
  // Unshaded it looks as what lies behind it: exactly where that is even, about so where it is not.
  const auto unshaded = [&] {
    return glm::dvec3(scene.materials.back().base_color) * floor_irradiance(scene.environment) / kPi;
  };
  const auto behind = [&] {
    const Environment& map = scene.environment;
    const glm::dvec3 forward = framing_forward();
    const glm::dvec2 uv = environment_uv({forward.x, -0.25, forward.z}, 0.0);
    return glm::dvec3(
        map.map[static_cast<std::size_t>(uv.y * map.height) * map.width + static_cast<std::size_t>(uv.x * map.width)]);
  };
  EXPECT_NEAR(unshaded().x / behind().x, 1.0, 0.25);
  scene.environment = sky_environment();
  relight_ground(scene);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(unshaded()[c] / behind()[c], 1.0, 1e-3);
  EXPECT_NEAR(scene.materials.back().base_color.g, 0.2f, 1e-3f); // the albedo of the ground under that sky
  scene.environment = studio_environment();
  relight_ground(scene);
  const glm::vec4 in_studio = scene.materials.back().base_color;
  scene.environment = load_environment("white");
  relight_ground(scene);
  EXPECT_NE(scene.materials.back().base_color, in_studio);
  EXPECT_NEAR(scene.materials.back().base_color.r, 0.9f, 1e-6f); // 1 would never end
}

TEST(Ground, LeavesNothingBehindWhereNotAskedFor) {
  Scene plain = scene_of({ball(1.0f)}), grounded = plain;
  plain.environment = grounded.environment = studio_environment();
  add_ground(grounded, world_bounds(grounded));
  const PackedScene without = pack(plain), with = pack(grounded);
  EXPECT_EQ(without.features & (gpu::kFeatureAlpha | gpu::kFeatureVertexColors), 0u);
  EXPECT_NE(with.features & gpu::kFeatureAlpha, 0u);
  EXPECT_EQ(without.materials.size(), 1u);
}

} // namespace
} // namespace wavepath::test
