// The point under the pointer: in a scene of one object, in one of instances, and where there is nothing.
#include "host/scene/pack/pick.h"

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/scene/pack/pack.h"
#include "kernels/base/features.h"
#include "tests/scene_builder.h"

namespace wavepath {
namespace {

// Looks along -Z from (0.25, 0.25, 5), half a metre to each side at a metre's distance.
View front_view() {
  View view;
  view.position = {0.25, 0.25, 5.0};
  view.right = {0.5, 0.0, 0.0};
  view.up = {0.0, 0.5, 0.0};
  return view;
}

void expect_picked(const Scene& scene, const View& view, const glm::dvec2& place, const glm::dvec3& expected) {
  Scene copy = scene;
  const PackedScene packed = pack(copy, {.eye = view.position});
  const auto point = pick(packed, view, place, {100, 100});
  ASSERT_TRUE(point);
  EXPECT_LE(glm::length(*point - expected), 1e-5) << point->x << " " << point->y << " " << point->z;
}

TEST(Pick, FindsThePointUnderThePointer) {
  const Scene scene = triangle_scene();
  expect_picked(scene, front_view(), {50, 50}, {0.25, 0.25, 0.0});
  expect_picked(scene, front_view(), {52, 46}, {0.35, 0.45, 0.0}); // y downwards
  View flat = front_view();
  flat.orthographic = true;
  expect_picked(scene, flat, {70, 50}, {0.45, 0.25, 0.0});
}

TEST(Pick, FindsTheNearestInstance) {
  Scene scene = triangle_scene();
  for (const double z : {-3.0, 2.0, 1.0}) {
    Instance& instance = scene.instances.emplace_back(scene.instances.front());
    instance.world_from_object =
        glm::translate(glm::dmat4(1.0), glm::dvec3(-1.0, -1.0, z)) * glm::scale(glm::dmat4(1.0), glm::dvec3(4.0));
  }
  expect_picked(scene, front_view(), {50, 50}, {0.25, 0.25, 2.0});
}

// A single-sided triangle in front of another one, its back to the eye.
TEST(Pick, SeesThroughBacks) {
  Scene scene = triangle_scene();
  scene.materials.push_back(plain_material());
  scene.materials[1].double_sided = false;
  add_instance(scene, add_mesh(scene, {{0, 0, 1}, {0, 1, 1}, {1, 0, 1}}, 1));
  expect_picked(scene, front_view(), {50, 50}, {0.25, 0.25, 0.0});
  const PackedScene packed = pack(scene);
  EXPECT_NEAR(depth_of_middle(packed, front_view()), 5.0, 1e-5);
  EXPECT_NEAR(depth_of_middle(packed, front_view(), false), 4.0, 1e-5);
}

TEST(Pick, MiddleOfTheSceneWhereThePictureShowsNothing) {
  Scene scene = triangle_scene();
  View view = front_view();
  view.position = {3.0, 3.0, 5.0};
  const PackedScene packed = pack(scene);
  EXPECT_NEAR(depth_of_middle(packed, view), 5.0, 1e-5);
  view.position.z = -5.0; // behind the camera: some distance all the same
  EXPECT_GT(depth_of_middle(packed, view), 0.0);
}

TEST(Pick, FindsNothingWhereNothingIs) {
  Scene scene = triangle_scene(), empty;
  const PackedScene packed = pack(scene);
  EXPECT_FALSE(pick(packed, front_view(), {1, 1}, {100, 100}));
  const PackedScene nothing = pack(empty);
  EXPECT_FALSE(pick(nothing, front_view(), {50, 50}, {100, 100}));
}

} // namespace
} // namespace wavepath
