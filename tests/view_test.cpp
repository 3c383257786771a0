// Cameras: glTF's, the user's own, and the framing of a scene that has none.
#include "host/scene/view.h"

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
  wide.aspect = 4.0; // the image's is used instead
  wide.world_from_camera =
      glm::translate(glm::dmat4(1.0), glm::dvec3(1e7, 2, 3)) * glm::scale(glm::dmat4(1.0), glm::dvec3(2.0));
  flat.name = "1"; // a name that looks like an index goes first
  flat.orthographic = true;
  flat.xmag = 5.0;
  flat.ymag = 3.0;
  scene.cameras = {wide, flat};
  return scene;
}

TEST(View, KeepsTheVerticalAngleAndTheImagesShape) {
  const View view = resolve_view(camera_scene(), {}, 200, 100);
  EXPECT_FALSE(view.orthographic);
  expect_near(view.position, {1e7, 2, 3});
  expect_near(view.forward, {0, 0, -1});
  expect_near(view.right, {1.0, 0, 0});
  expect_near(view.up, {0, 0.5, 0});
}

TEST(View, KeepsTheHeightOfOrthographicCameras) {
  const View view = resolve_view(camera_scene(), {.camera = "1"}, 100, 200);
  EXPECT_TRUE(view.orthographic);
  expect_near(view.right, {1.5, 0, 0});
  expect_near(view.up, {0, 3, 0});
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
  const View turned = resolve_view(camera_scene(), target_only, 100, 100);
  expect_near(turned.position, {1e7, 2, 3});
  expect_near(turned.forward, {1, 0, 0});
  expect_near(turned.up, {0, 0.5, 0});
  ViewRequest rolled;
  rolled.up = glm::dvec3(1, 0, 0);
  expect_near(resolve_view(camera_scene(), rolled, 100, 100).up, {0.5, 0, 0});
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

TEST(View, FramesAnEmptyScene) {
  const View view = resolve_view(Scene{}, {}, 100, 100);
  EXPECT_GT(glm::length(view.position), 1.0);
  EXPECT_NEAR(glm::length(view.forward), 1.0, 1e-12);
}

} // namespace
} // namespace wavepath
