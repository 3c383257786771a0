// Geometry as packed: origin, baking, winding, instancing, streams, dropped triangles, trees and stack bounds.
#include "host/scene/pack.h"

#include <gtest/gtest.h>

#include "tests/scene_builder.h"

namespace wavepath {
namespace {

TEST(Pack, PutsTheOriginIntoTheMiddleOfTheGeometry) {
  Scene scene = triangle_scene();
  scene.instances[0].world_from_object[3] = {1e6, -2e6, 3e6, 1.0};
  const PackedScene packed = pack(scene);
  EXPECT_EQ(packed.origin, glm::dvec3(1e6 + 0.5, -2e6 + 0.5, 3e6));
  ASSERT_EQ(packed.triangles.size(), 1u);
  EXPECT_EQ(packed.triangles[0].v0, glm::vec3(-0.5f, -0.5f, 0.0f));
  EXPECT_EQ(packed.triangles[0].v1, glm::vec3(0.5f, -0.5f, 0.0f));
  EXPECT_EQ(packed.triangles[0].v2, glm::vec3(-0.5f, 0.5f, 0.0f));
  EXPECT_DOUBLE_EQ(packed.radius, std::sqrt(0.5));
}

} // namespace
} // namespace wavepath
