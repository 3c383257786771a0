// The camera that the user moves: where it goes, and that its flags say exactly where it is.
#include "host/session/viewing/camera_control.h"
#include "host/scene/staging/view_flags.h"

#include <cmath>
#include <numbers>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/base/error.h"
#include "tests/scene_builder.h"

namespace wavepath {
namespace {

constexpr double kQuarter = std::numbers::pi / 2;

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-12) {
  EXPECT_LE(glm::length(a - b), tolerance)
      << a.x << " " << a.y << " " << a.z << " instead of " << b.x << " " << b.y << " " << b.z;
}

Framing unit_framing() {
  Framing framing;
  framing.bounds.add(glm::dvec3(-1.0));
  framing.bounds.add(glm::dvec3(1.0));
  return framing;
}

// From (0, 0, 4) along -Z, at the middle of a box of half extent 1.
CameraControl front_camera() {
  Scene scene = triangle_scene();
  Camera camera, second;
  camera.yfov = kQuarter;
  camera.world_from_camera = glm::translate(glm::dmat4(1.0), glm::dvec3(0, 0, 4));
  second.name = "0";
  second.orthographic = true;
  scene.cameras = {camera, second};
  return CameraControl(scene, unit_framing(), {});
}

TEST(CameraControl, OrbitsAboutTheTarget) {
  CameraControl control = front_camera();
  control.orbit(kQuarter, 0.0); // the scene follows the pointer to the right: the eye goes to the left
  expect_near(control.view().position, {-4, 0, 0});
  expect_near(control.view().forward, {1, 0, 0});
  control.orbit(0.0, 0.5);
  expect_near(control.view().position, {-4 * std::cos(0.5), 4 * std::sin(0.5), 0});
  EXPECT_NEAR(control.view().right.y, 0.0, 1e-12);
}

TEST(CameraControl, NeverTurnsOverThePoles) {
  for (const double down : {10.0, -10.0}) {
    CameraControl control = front_camera();
    control.orbit(0.3, down);
    EXPECT_GT(control.view().up.y, 0.0);
    EXPECT_GT(std::abs(control.view().forward.y), 0.99);
    control.look(0.3, -down);
    EXPECT_GT(control.view().up.y, 0.0);
  }
}

TEST(CameraControl, LooksAroundFromWhereItIs) {
  CameraControl control = front_camera();
  control.look(kQuarter, 0.0);
  expect_near(control.view().position, {0, 0, 4});
  expect_near(control.view().forward, {1, 0, 0});
  control.look(0.0, 0.5);
  EXPECT_LT(control.view().forward.y, 0.0);
}

// A point at the target's distance stays under the pointer.
TEST(CameraControl, PansWithThePicture) {
  CameraControl control = front_camera();
  const double height = 2.0 * 4.0 * std::tan(kQuarter / 2); // of the picture at the target
  control.pan(0.25, 0.5);
  expect_near(control.view().position, {-0.25 * height, 0.5 * height, 4});
  expect_near(control.view().forward, {0, 0, -1});
}

TEST(CameraControl, DolliesAndFlies) {
  CameraControl control = front_camera();
  control.dolly(std::log(2.0));
  expect_near(control.view().position, {0, 0, 2});
  control.dolly(1e6); // neither through the target nor onto it
  EXPECT_GT(control.view().position.z, 0.0);
  control.reset();
  const double radius = std::sqrt(3.0);
  control.fly({1.0, 2.0, 3.0});
  expect_near(control.view().position, {radius, 2 * radius, 4 - 3 * radius});
  expect_near(control.view().forward, {0, 0, -1});
}

TEST(CameraControl, FocusesOnAPoint) {
  CameraControl control = front_camera();
  EXPECT_TRUE(control.focus({1, 1, 0}));
  expect_near(control.view().forward, glm::normalize(glm::dvec3(1, 1, -4)));
  EXPECT_FALSE(control.focus({0, 0, 4})); // where the eye is
  EXPECT_TRUE(control.focus({0, 10, 4})); // straight above
  expect_near(control.view().forward, {0, 1, 0});
}

// A window made narrow shows what the camera was authored to show, and is as before when it is wide again.
TEST(CameraControl, CropsNothingWhenTheWindowIsResized) {
  Scene scene = triangle_scene();
  Camera camera;
  camera.yfov = kQuarter;
  camera.aspect = 2.0;
  scene.cameras = {camera};
  CameraControl control(scene, unit_framing(), {});
  const auto expect_extent = [&](std::uint32_t width, std::uint32_t height, double right, double up) {
    control.resize(width, height);
    EXPECT_NEAR(glm::length(control.view().right), right, 1e-12);
    EXPECT_NEAR(glm::length(control.view().up), up, 1e-12);
  };
  expect_extent(400, 200, 2.0, 1.0);
  expect_extent(100, 200, 2.0, 4.0);
  expect_extent(800, 200, 4.0, 1.0);
  expect_extent(400, 200, 2.0, 1.0);
}

TEST(CameraControl, ChoosesFramesAndResets) {
  CameraControl control = front_camera();
  EXPECT_FALSE(control.choose(2));
  EXPECT_TRUE(control.choose(1)); // called "0"
  EXPECT_TRUE(control.view().orthographic);
  control.reset();
  control.fly({5.0, 0.0, 0.0});
  control.frame_scene();
  expect_near(control.view().forward, {0, 0, -1});
  expect_near(control.view().position, {0, 0, std::sqrt(3.0) / std::sin(kQuarter / 2)});
  control.reset();
  expect_near(control.view().position, {0, 0, 4});
}

TEST(CameraControl, FramesTheSceneInPanoramas) {
  const auto distance = [](const ViewRequest& request) {
    CameraControl control(triangle_scene(), unit_framing(), request);
    control.frame_scene();
    return glm::length(control.view().position);
  };
  const double radius = std::sqrt(3.0);
  EXPECT_NEAR(distance({.projection = Projection::fisheye, .fov = 1.0}), radius / std::sin(0.5), 1e-9);
  const double outside = radius / std::sin(glm::radians(60.0));
  EXPECT_NEAR(distance({.projection = Projection::fisheye, .fov = 3.5}), outside, 1e-9);
  EXPECT_NEAR(distance({.projection = Projection::equirectangular}), outside, 1e-9);
}

// Another camera of the file is seen by the lens that the flags ask for, in the window and by the copied line.
TEST(CameraControl, KeepsTheLensOfTheFlags) {
  Scene scene = triangle_scene();
  Camera first, second, flat;
  second.world_from_camera = glm::translate(glm::dmat4(1.0), glm::dvec3(0, 0, 4));
  second.yfov = 1.0;
  flat.orthographic = true;
  scene.cameras = {first, second, flat};
  const std::pair<ViewRequest, const char*> lenses[] = {
      {{.projection = Projection::fisheye, .fov = 2.0, .shift = glm::dvec2(0.25, 0.0)},
       " --camera 1 --projection fisheye --fov 114.59155902616465 --shift 0.25,0"},
      {{.projection = Projection::equirectangular, .stereo = 0.064},
       " --camera 1 --projection equirectangular --stereo 0.064"},
      {{.projection = Projection::orthographic, .ymag = 2.0, .clip = Clip{1.0, 3.0}},
       " --camera 1 --projection orthographic --ymag 2 --clip 1,3"},
      {{.intrinsics = Intrinsics{100.0, 100.0, 40.0, 50.0}}, " --camera 1 --intrinsics 100,100,40,50"},
      {{.clips_as_file = true}, " --camera 1 --clip file"},
      {{.yfov = 0.5}, " --camera 1"}}; // an angle is the chosen camera's
  for (const auto& [lens, flags] : lenses) {
    SCOPED_TRACE(flags);
    ViewRequest moved = lens;
    moved.eye = glm::dvec3(1, 2, 3);
    CameraControl control(scene, unit_framing(), moved);
    EXPECT_TRUE(control.choose(1));
    EXPECT_EQ(camera_flags(control.request()), flags);
    expect_near(control.view().position, {0, 0, 4});
  }
}

// Parallel rays have no angle to become perspective by: the camera stays where it was.
TEST(CameraControl, StaysWhereALensDoesNotFit) {
  Scene scene = triangle_scene();
  Camera first, flat;
  flat.orthographic = true;
  scene.cameras = {first, flat};
  for (const ViewRequest& lens : {ViewRequest{.projection = Projection::perspective}, ViewRequest{.stereo = 0.1}}) {
    CameraControl control(scene, unit_framing(), lens);
    control.fly({1.0, 0.0, 0.0});
    const std::string before = camera_flags(control.request());
    EXPECT_THROW(control.choose(1), UsageError);
    EXPECT_EQ(camera_flags(control.request()), before);
  }
  CameraControl control(scene, unit_framing(), {.yfov = 0.5, .projection = Projection::perspective});
  EXPECT_TRUE(control.choose(1));
  EXPECT_EQ(camera_flags(control.request()),
            fmt::format(" --camera 1 --yfov {} --projection perspective", glm::degrees(0.5)));
}

TEST(CameraControl, StaysAmongNumbers) {
  CameraControl control = front_camera();
  for (int i = 0; i < 100; ++i) control.dolly(-10.0), control.fly({1e300, 0, 0}), control.pan(1e10, -1e10);
  EXPECT_TRUE(finite_point(control.view().position));
  EXPECT_NEAR(glm::length(control.view().forward), 1.0, 1e-9);
}

// Reads the flags as a shell and the command line would.
ViewRequest read(const std::string& flags) {
  std::istringstream words(flags);
  ViewRequest request;
  const auto number = [](const std::string& text) { return std::strtod(text.c_str(), nullptr); };
  for (std::string flag, value; words >> flag >> value;) {
    const auto second = value.find(','), third = value.find(',', second + 1);
    const auto triple = [&] {
      return glm::dvec3(number(value.substr(0, second)), number(value.substr(second + 1)),
                        number(value.substr(third + 1)));
    };
    if (flag == "--camera") request.camera = value;
    if (flag == "--eye") request.eye = triple();
    if (flag == "--look-at") request.look_at = triple();
    if (flag == "--up") request.up = triple();
    if (flag == "--yfov") request.yfov = glm::radians(number(value));
  }
  return request;
}

TEST(CameraControl, WritesFlagsThatMakeTheSameView) {
  CameraControl control = front_camera();
  EXPECT_EQ(camera_flags(control.request()), "");
  for (int i = 0; i < 200; ++i) {
    control.orbit(0.1 * i, 0.013);
    control.fly({1e-3, 1.0 / 3.0, -1e-7});
    const ViewRequest again = read(camera_flags(control.request()));
    ASSERT_EQ(again.eye, control.request().eye);
    ASSERT_EQ(again.look_at, control.request().look_at);
    ASSERT_EQ(again.up, control.request().up);
  }
  control.choose(1);
  EXPECT_EQ(camera_flags(control.request()), " --camera 1");
  control.choose(0); // not the one that is called "0"
  EXPECT_FALSE(control.view().orthographic);
}

TEST(CameraControl, WritesAnglesThatMakeTheSameBits) {
  for (int i = 1; i < 1800; ++i) {
    const double radians = glm::radians(0.1 * i);
    const ViewRequest request{.yfov = radians};
    ASSERT_EQ(read(camera_flags(request)).yfov, radians) << i;
  }
}

} // namespace
} // namespace wavepath
