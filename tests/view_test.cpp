// Cameras: glTF's, the user's own, and the framing of a scene that has none.
#include "host/scene/staging/view.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/base/error.h"
#include "tests/scene_builder.h"

namespace wavepath {
namespace {

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-12) {
  EXPECT_LE(glm::length(a - b), tolerance)
      << a.x << " " << a.y << " " << a.z << " instead of " << b.x << " " << b.y << " " << b.z;
}

Scene camera_scene() {
  Scene scene = triangle_scene();
  Camera wide, flat;
  wide.name = "wide";
  wide.yfov = 2.0 * std::atan(0.5);
  wide.aspect = 4.0;
  wide.world_from_camera =
      glm::translate(glm::dmat4(1.0), glm::dvec3(1e7, 2, 3)) * glm::scale(glm::dmat4(1.0), glm::dvec3(2.0));
  flat.name = "1"; // a name that looks like an index goes first
  flat.orthographic = true;
  flat.xmag = 5.0;
  flat.ymag = 3.0;
  scene.cameras = {wide, flat};
  return scene;
}

TEST(View, KeepsTheVerticalAngleInImagesAsWideAsTheCamera) {
  for (const std::uint32_t width : {400u, 800u}) {
    const View view = resolve_view(camera_scene(), {}, width, 100);
    EXPECT_FALSE(view.orthographic);
    expect_near(view.position, {1e7, 2, 3});
    expect_near(view.forward, {0, 0, -1});
    expect_near(view.right, {0.5 * width / 100.0, 0, 0});
    expect_near(view.up, {0, 0.5, 0});
  }
}

TEST(View, KeepsTheHorizontalAngleInNarrowerImages) {
  for (const std::uint32_t height : {101u, 200u, 4000u}) {
    const View view = resolve_view(camera_scene(), {}, 400, height);
    expect_near(view.right, {2.0, 0, 0}); // 4 to 1, and half of 1 high
    expect_near(view.up, {0, 2.0 * height / 400.0, 0});
  }
}

TEST(View, CropsNothingOfOrthographicCameras) {
  const auto expect_extent = [](std::uint32_t width, std::uint32_t height, double right, double up) {
    const View view = resolve_view(camera_scene(), {.camera = "1"}, width, height);
    EXPECT_TRUE(view.orthographic);
    expect_near(view.right, {right, 0, 0});
    expect_near(view.up, {0, up, 0});
  };
  expect_extent(500, 300, 5.0, 3.0);
  expect_extent(200, 100, 6.0, 3.0);
  expect_extent(100, 100, 5.0, 5.0);
  expect_extent(100, 200, 5.0, 10.0);
}

TEST(View, AnyImageFitsACameraWithoutAnAspectRatioOrWithAnAngleOfTheUsers) {
  Scene scene = camera_scene();
  expect_near(resolve_view(scene, {.yfov = std::numbers::pi / 2}, 50, 100).right, {0.5, 0, 0});
  scene.cameras[0].aspect = 0.0;
  expect_near(resolve_view(scene, {}, 50, 100).right, {0.25, 0, 0});
}

// Exporters store the ratio as a float: the picture that it was made for has the same bits as without it.
TEST(View, RoundingOfTheAspectRatioMovesNothing) {
  Scene scene = camera_scene();
  for (const auto& [width, height] : {std::pair{1280u, 720u}, std::pair{640u, 480u}, std::pair{1000u, 300u}}) {
    scene.cameras[0].aspect = std::nextafter(static_cast<float>(width) / static_cast<float>(height), 9.0f);
    const View view = resolve_view(scene, {}, width, height);
    EXPECT_EQ(glm::length(view.up), std::tan(0.5 * scene.cameras[0].yfov));
  }
}

TEST(View, FindsCamerasByNameAndIndex) {
  const Scene scene = camera_scene();
  EXPECT_FALSE(resolve_view(scene, {.camera = "wide"}, 1, 1).orthographic);
  EXPECT_FALSE(resolve_view(scene, {.camera = "0"}, 1, 1).orthographic);
  for (const char* unknown : {"2", "-1", "0x", "tall"}) try {
      resolve_view(scene, {.camera = unknown}, 1, 1);
      ADD_FAILURE() << unknown;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("choose one of: 0 'wide', 1 '1'"), std::string::npos) << error.what();
    }
  EXPECT_THROW(resolve_view(triangle_scene(), {.camera = "0"}, 1, 1), Error);
}

TEST(View, TakesTheUsersOwnCamera) {
  ViewRequest request;
  request.eye = glm::dvec3(0, 0, 10);
  request.look_at = glm::dvec3(10, 0, 10);
  request.yfov = std::numbers::pi / 2;
  const View view = resolve_view(camera_scene(), request, 100, 100);
  expect_near(view.position, {0, 0, 10});
  expect_near(view.forward, {1, 0, 0});
  expect_near(view.right, {0, 0, 1});
  expect_near(view.up, {0, 1, 0});
}

TEST(View, TakesWhatIsLeftOutFromTheCamera) {
  ViewRequest eye_only;
  eye_only.eye = glm::dvec3(7, 8, 9);
  expect_near(resolve_view(camera_scene(), eye_only, 1, 1).forward, {0, 0, -1});
  ViewRequest target_only;
  target_only.look_at = glm::dvec3(1e7 + 5, 2, 3);
  const View turned = resolve_view(camera_scene(), target_only, 400, 100);
  expect_near(turned.position, {1e7, 2, 3});
  expect_near(turned.forward, {1, 0, 0});
  expect_near(turned.up, {0, 0.5, 0});
  ViewRequest rolled;
  rolled.up = glm::dvec3(1, 0, 0);
  expect_near(resolve_view(camera_scene(), rolled, 400, 100).up, {0.5, 0, 0});
  ViewRequest with_angle;
  with_angle.camera = "1";
  with_angle.yfov = std::numbers::pi / 2;
  EXPECT_FALSE(resolve_view(camera_scene(), with_angle, 1, 1).orthographic);
}

TEST(View, StaysLevelWhenALevelCameraIsTurned) {
  Scene scene = camera_scene();
  scene.cameras[0].world_from_camera = glm::rotate(glm::dmat4(1.0), -0.5, glm::dvec3(1, 0, 0)); // looks down
  ViewRequest request;
  request.look_at = glm::dvec3(10, 1, 0);
  const View view = resolve_view(scene, request, 100, 100);
  EXPECT_NEAR(view.right.y, 0.0, 1e-12);
  EXPECT_GT(view.up.y, 0.0);
}

TEST(View, RefusesDegenerateRequests) {
  const glm::dvec3 p(1, 2, 3);
  EXPECT_THROW(resolve_view(camera_scene(), {.eye = p, .look_at = p}, 1, 1), UsageError);
  EXPECT_THROW(resolve_view(camera_scene(), {.eye = p, .look_at = p + glm::dvec3(0, 1, 0)}, 1, 1), UsageError);
  EXPECT_THROW(resolve_view(camera_scene(), {.eye = p, .look_at = glm::dvec3(0.0), .up = p}, 1, 1), UsageError);
  EXPECT_THROW(resolve_view(camera_scene(), {.up = glm::dvec3(0.0)}, 1, 1), UsageError);
  EXPECT_THROW(resolve_view(camera_scene(), {.eye = glm::dvec3(NAN, 0, 0)}, 1, 1), UsageError);
  for (const double yfov : {0.0, -1.0, std::numbers::pi, static_cast<double>(NAN)})
    EXPECT_THROW(resolve_view(camera_scene(), {.yfov = yfov}, 1, 1), UsageError);
  Scene flat = camera_scene();
  flat.cameras[0].world_from_camera = glm::scale(glm::dmat4(1.0), glm::dvec3(0.0));
  EXPECT_THROW(resolve_view(flat, {}, 1, 1), Error);
}

TEST(View, LooksAtTheMiddleFromAnEyeOfTheUsersOwn) {
  ViewRequest request;
  request.eye = glm::dvec3(0.5, 0.5, 10.0);
  expect_near(resolve_view(triangle_scene(), request, 1, 1).forward, {0, 0, -1});
}

TEST(View, ShiftsByFractionsOfThePicture) {
  const View shifted = resolve_view(camera_scene(), {.shift = glm::dvec2(0.5, -0.25)}, 400, 100);
  EXPECT_EQ(shifted.shift, glm::dvec2(1.0, -0.5)); // in halves of it
  expect_near(shifted.forward, {0, 0, -1});
  // Parallel rays move with their camera.
  const View flat = resolve_view(camera_scene(), {.camera = "1", .shift = glm::dvec2(0.5, -0.25)}, 200, 100);
  EXPECT_FALSE(has_camera_model(flat));
  expect_near(flat.position, {6.0, -1.5, 0.0});
}

TEST(View, IntrinsicsPutPointsWhereTheirMatrixDoes) {
  const Intrinsics k{300.0, 250.0, 190.0, 60.0};
  const View view = resolve_view(camera_scene(), {.intrinsics = k}, 400, 100);
  const glm::dvec3 point(0.3, -0.2, 2.0); // right, down, ahead
  const glm::dvec2 pixel(k.fx * point.x / point.z + k.cx, k.fy * point.y / point.z + k.cy);
  glm::dvec3 origin, direction;
  ASSERT_TRUE(ray_through(view, {pixel.x / 200.0 - 1.0, 1.0 - pixel.y / 50.0}, origin, direction));
  expect_near(point.z * direction, {0.3, 0.2, -2.0});
}

TEST(View, TellsItsMatrixAndItsAngles) {
  const Intrinsics k{300.0, 250.0, 190.0, 60.0};
  const auto expect_same = [&](const View& view, std::uint32_t width) {
    const Intrinsics told = intrinsics_of(view, width, 100).value();
    EXPECT_NEAR(told.fx, k.fx, 1e-9);
    EXPECT_NEAR(told.fy, k.fy, 1e-9);
    EXPECT_NEAR(told.cx, k.cx, 1e-9);
    EXPECT_NEAR(told.cy, k.cy, 1e-9);
  };
  for (const Projection projection : {Projection::perspective, Projection::fisheye})
    for (const double stereo : {0.0, 0.1}) {
      const std::uint32_t width = stereo == 0.0 ? 400 : 800;
      const View view =
          resolve_view(camera_scene(), {.projection = projection, .intrinsics = k, .stereo = stereo}, width, 100);
      expect_same(view, width);
    }
  // From the left edge to the right one, and from the top to the bottom.
  const View view = resolve_view(camera_scene(), {.intrinsics = k}, 400, 100);
  const glm::dvec2 angles = angles_of(view).value();
  EXPECT_NEAR(angles.x, std::atan(190.0 / 300.0) + std::atan(210.0 / 300.0), 1e-12);
  EXPECT_NEAR(angles.y, std::atan(60.0 / 250.0) + std::atan(40.0 / 250.0), 1e-12);
  const View sphere = resolve_view(camera_scene(), {.projection = Projection::equirectangular}, 400, 200);
  EXPECT_FALSE(intrinsics_of(sphere, 400, 200));
  expect_near({angles_of(sphere).value(), 0.0}, {2.0 * std::numbers::pi, std::numbers::pi, 0.0});
  const View fisheye = resolve_view(camera_scene(), {.projection = Projection::fisheye, .fov = 3.0}, 400, 100);
  expect_near({angles_of(fisheye).value(), 0.0}, {3.0, 3.0, 0.0}); // a circle in the middle
  EXPECT_FALSE(angles_of(resolve_view(camera_scene(), {.camera = "1"}, 4, 4)));
}

TEST(View, BecomesOrthographicAsLargeAsAtItsTarget) {
  const View view = resolve_view(
      camera_scene(), {.eye = glm::dvec3(0, 0, 8), .look_at = glm::dvec3(0.0), .projection = Projection::orthographic},
      400, 100);
  EXPECT_TRUE(view.orthographic);
  expect_near(view.up, {0, 4, 0}); // half of the distance
  expect_near(view.right, {16, 0, 0});
  const View given = resolve_view(camera_scene(), {.projection = Projection::orthographic, .ymag = 2.0}, 400, 100);
  expect_near(given.up, {0, 2, 0});
  EXPECT_THROW(resolve_view(camera_scene(), {.camera = "1", .projection = Projection::perspective}, 4, 4), UsageError);
  EXPECT_THROW(resolve_view(camera_scene(), {.camera = "1", .stereo = 0.1}, 4, 4), UsageError);
}

TEST(View, ClipsAsTheFileSays) {
  Scene scene = camera_scene();
  scene.cameras[0].znear = 0.5;
  EXPECT_EQ(resolve_view(scene, {}, 4, 4).clip, Clip{});
  EXPECT_EQ(resolve_view(scene, {.clips_as_file = true}, 4, 4).clip, (Clip{.near = 0.5}));
  scene.cameras[0].zfar = 7.0;
  EXPECT_EQ(resolve_view(scene, {.clips_as_file = true}, 4, 4).clip, (Clip{0.5, 7.0}));
  scene.cameras[0].zfar = 0.5;
  EXPECT_THROW(resolve_view(scene, {.clips_as_file = true}, 4, 4), Error);
  EXPECT_THROW(resolve_view(Scene{}, {.clips_as_file = true}, 4, 4), UsageError);
}

TEST(View, EyesHalveThePicture) {
  const View beside = resolve_view(camera_scene(), {.stereo = 0.1}, 800, 100);
  expect_near(beside.right, {2.0, 0, 0}); // 400 by 100
  const View fisheye = resolve_view(camera_scene(), {.projection = Projection::fisheye, .stereo = 0.1}, 800, 100);
  expect_near(fisheye.right, {2.0 * std::numbers::pi, 0, 0});
  expect_near(fisheye.up, {0, 0.5 * std::numbers::pi, 0});
}

TEST(View, FramesAnEmptyScene) {
  const View view = resolve_view(Scene{}, {}, 100, 100);
  EXPECT_GT(glm::length(view.position), 1.0);
  EXPECT_NEAR(glm::length(view.forward), 1.0, 1e-12);
}

} // namespace
} // namespace wavepath
