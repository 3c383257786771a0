// Tangents made for normal maps.
#include <cmath>

#include <gtest/gtest.h>

#include "host/scene/gltf/tangents.h"
#include "tests/gltf_checks.h"

namespace wavepath {
namespace {

using test::expect_near;

Mesh quad(bool mirrored) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.uvs[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}}; // the image upright: v points down
  if (mirrored)
    for (glm::vec2& uv : mesh.uvs[0]) uv.x = -uv.x;
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

TEST(Tangents, PointAlongUAndSayTheHandedness) {
  Mesh upright = quad(false), mirrored = quad(true);
  generate_tangents(upright, upright.uvs[0]);
  generate_tangents(mirrored, mirrored.uvs[0]);
  ASSERT_EQ(upright.tangents.size(), 4u);
  ASSERT_EQ(mirrored.tangents.size(), 4u);
  for (const glm::vec4& t : upright.tangents) EXPECT_EQ(t, glm::vec4(1, 0, 0, 1));
  for (const glm::vec4& t : mirrored.tangents) EXPECT_EQ(t, glm::vec4(-1, 0, 0, -1));
}

TEST(Tangents, VerticesAreSplitWhereHandednessChanges) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.uvs[0] = {{0, 1}, {0, 0}, {1, 1}, {1, 1}}; // the left triangle mirrors the right one
  mesh.colors.assign(4, {1, 1, 1, 1});
  mesh.indices = {0, 2, 1, 0, 1, 3};
  generate_tangents(mesh, mesh.uvs[0]);
  EXPECT_EQ(mesh.positions.size(), 6u);
  EXPECT_EQ(mesh.tangents.size(), 6u);
  EXPECT_EQ(mesh.colors.size(), 6u);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(mesh.tangents[mesh.indices[static_cast<std::size_t>(k)]], glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(mesh.tangents[mesh.indices[static_cast<std::size_t>(3 + k)]], glm::vec4(-1, 0, 0, -1));
  }
  EXPECT_EQ(mesh.positions[mesh.indices[3]], glm::vec3(0, 0, 0));
}

TEST(Tangents, AreWeightedByTheAngleOfTheFace) {
  // Around vertex 0: a face of 90 degrees with its tangent along (1,0) and one of 45 degrees with its tangent along
  // (1,1).
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 1, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.uvs[0] = {{0, 0}, {1, 0}, {0, -1}, {-1, -2}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  generate_tangents(mesh, mesh.uvs[0]);
  expect_near(glm::vec3(mesh.tangents[mesh.indices[0]]),
              glm::normalize(glm::dvec3(2 + std::sqrt(0.5), std::sqrt(0.5), 0)), 1e-6);
  expect_near(glm::vec3(mesh.tangents[mesh.indices[5]]), {std::sqrt(0.5), std::sqrt(0.5), 0}, 1e-6);
}

TEST(Tangents, OfFlatAndDegenerateTriangles) {
  Mesh flat = quad(false);
  flat.normals.clear();
  flat.uvs[0][2] = flat.uvs[0][3] = flat.uvs[0][0]; // the second triangle has no uv area
  generate_tangents(flat, flat.uvs[0]);
  for (const glm::vec4& t : flat.tangents) {
    EXPECT_NEAR(glm::length(glm::vec3(t)), 1.0f, 1e-6f);
    EXPECT_NEAR(t.z, 0.0f, 1e-6f);
    EXPECT_EQ(std::abs(t.w), 1.0f);
  }
  Mesh without = quad(false);
  generate_tangents(without, {});
  for (const glm::vec4& t : without.tangents) EXPECT_NEAR(glm::length(glm::vec3(t)), 1.0f, 1e-6f);
}

} // namespace
} // namespace wavepath
