// Huge triangles cut into pieces: that pieces fit together, cover what was there, and carry its attributes and light.
#include "host/scene/pack/cut_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/scene/pack/pack.h"
#include "host/scene/pack/plan.h"
#include "tests/scene_builder.h"

namespace wavepath {
namespace {

glm::dmat4 tilt(double radians) { return glm::rotate(glm::dmat4(1.0), radians, glm::normalize(glm::dvec3(1, 2, 3))); }

// Two triangles around zero in the plane y = 0, that share four vertices.
Mesh ground(float half) {
  Mesh mesh;
  mesh.positions = {{-half, 0, half}, {half, 0, half}, {half, 0, -half}, {-half, 0, -half}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.primitives = {{0, 6, 0, false}};
  return mesh;
}

Scene ground_scene(float half, const glm::dmat4& world_from_object = glm::dmat4(1.0)) {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  scene.meshes.push_back(ground(half));
  add_instance(scene, 0, world_from_object);
  return scene;
}

std::vector<Part> parts_of(const Scene& scene) {
  std::vector<Part> parts;
  for (const Instance& instance : scene.instances)
    for (std::uint32_t p = 0; p < scene.meshes[instance.mesh].primitives.size(); ++p)
      parts.push_back({instance.mesh, p, 0, 0, instance.world_from_object});
  return parts;
}

Cut cut_of(const Scene& scene, const std::vector<glm::dvec3>& near) { return cut_huge(scene, parts_of(scene), near); }

double area_of(const Piece& piece) {
  return 0.5 * glm::length(glm::cross(piece.position[1] - piece.position[0], piece.position[2] - piece.position[0]));
}

using Point = std::array<double, 3>;
Point key(const glm::dvec3& p) { return {p.x, p.y, p.z}; }

// How often each edge is met, by its ends.
std::map<std::pair<Point, Point>, int> count_edges(const Cut& cut) {
  std::map<std::pair<Point, Point>, int> edges;
  for (const Piece& piece : cut.pieces)
    for (int k = 0; k < 3; ++k) {
      const Point a = key(piece.position[k]), b = key(piece.position[(k + 1) % 3]);
      ++edges[std::minmax(a, b)];
    }
  return edges;
}

TEST(CutHuge, LeavesOrdinaryTrianglesAlone) {
  EXPECT_TRUE(cut_of(ground_scene(10.0f), {{0.0, 2.0, 0.0}}).empty());
  EXPECT_TRUE(cut_of(ground_scene(1e6f), {}).empty());
  EXPECT_TRUE(cut_of(ground_scene(1e6f), {{0.0, 2e5, 0.0}}).empty());
  EXPECT_TRUE(cut_of(triangle_scene(), {{0.5, 0.5, 0.3}}).empty());
  EXPECT_FALSE(cut_of(ground_scene(20.0f), {{0.0, 2.0, 0.0}}).empty());
}

// Every edge within the square is that of two pieces, so that no vertex lies on an edge of a neighbour.
TEST(CutHuge, PiecesFitTogether) {
  for (const double half : {1e2, 1e4, 1e7}) {
    const glm::dmat4 turn = tilt(half), back = glm::inverse(turn);
    const Scene scene = ground_scene(static_cast<float>(half), turn);
    const Cut cut = cut_of(scene, {turn * glm::dvec4(0.3 * half, 1.7, 0.11 * half, 1.0)});
    ASSERT_EQ(cut.triangles.size(), 2u);
    EXPECT_LT(cut.pieces.size(), 4000u);
    double area = 0.0;
    for (const Piece& piece : cut.pieces) area += area_of(piece);
    EXPECT_NEAR(area / (4.0 * half * half), 1.0, 1e-12);
    for (const auto& [edge, count] : count_edges(cut)) {
      const auto at = [&](const Point& p) { return glm::dvec3(back * glm::dvec4(p[0], p[1], p[2], 1.0)); };
      const glm::dvec3 a = at(edge.first), b = at(edge.second);
      const auto on_rim = [&](int axis) {
        return std::abs(std::abs(a[axis]) - half) < 1e-9 * half && std::abs(a[axis] - b[axis]) < 1e-9 * half;
      };
      EXPECT_EQ(count, on_rim(0) || on_rim(2) ? 1 : 2);
    }
  }
}

// The other triangle is an eighth of the ratio at which it would be cut by itself, and another mesh with a transform
// of its own.
TEST(CutHuge, NeighboursAreSplitAlike) {
  Scene scene = ground_scene(1e3f);
  Mesh wall;
  wall.positions = {{-500, 0, 500}, {500, 0, 500}, {0, 2000, 500}};
  wall.indices = {0, 2, 1};
  wall.primitives = {{0, 3, 0, false}};
  scene.meshes.push_back(wall);
  add_instance(scene, 1, glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(0)), glm::dvec3(2.0)));
  const Cut cut = cut_of(scene, {{10.0, 1.0, 700.0}});
  ASSERT_EQ(cut.triangles.size(), 3u);
  for (const auto& [edge, count] : count_edges(cut)) {
    const bool on_seam = edge.first[2] == 1e3 && edge.second[2] == 1e3 && edge.first[1] == 0.0 && edge.second[1] == 0.0;
    EXPECT_TRUE(!on_seam || count == 2) << edge.first[0] << " " << edge.second[0];
  }
}

TEST(CutHuge, PiecesAreAsSmallAsTheyAreNear) {
  const glm::dvec3 eye(123.0, 1.7, -45.0);
  double nearest = 1e300;
  for (const Piece& piece : cut_of(ground_scene(1e7f), {eye}).pieces) {
    double longest = 0.0, distance = 1e300;
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, glm::distance(piece.position[k], piece.position[(k + 1) % 3]));
      distance = std::min(distance, glm::distance(piece.position[k], eye));
    }
    EXPECT_LE(longest, 2.0 * distance);
    nearest = std::min(nearest, distance);
  }
  EXPECT_LT(nearest, 3.0);
}

TEST(CutHuge, TellsWhenThereWereTooMany) {
  Scene scene = ground_scene(1e7f);
  EXPECT_FALSE(cut_of(scene, {{3e5, 1.0, 1.1e5}}).coarse);
  for (int i = 0; i < 600; ++i)
    add_instance(scene, 0, glm::translate(glm::dmat4(1.0), glm::dvec3(0.0, -1e-3 * i, 0.0)));
  const Cut cut = cut_of(scene, {{3e5, 1.0, 1.1e5}});
  EXPECT_TRUE(cut.coarse);
  EXPECT_LE(cut.pieces.size(), kMostPieces);
  EXPECT_GT(cut.pieces.size(), kMostPieces / 16);
}

TEST(CutHuge, AnEyeInThePlaneEnds) {
  const Cut cut = cut_of(ground_scene(1e6f), {{0.0, 0.0, 0.0}, {12.0, 0.0, 77.0}});
  EXPECT_FALSE(cut.coarse);
  EXPECT_LT(cut.pieces.size(), 10000u);
}

TEST(CutHuge, MotionIsCutToo) {
  Scene scene = ground_scene(1e5f);
  for (const glm::vec3& p : scene.meshes[0].positions) scene.meshes[0].end_positions.push_back(p + glm::vec3(0, 64, 0));
  const Cut cut = cut_of(scene, {{0.0, 65.0, 0.0}}); // far from where it is at first
  ASSERT_FALSE(cut.empty());
  for (const Piece& piece : cut.pieces)
    for (int k = 0; k < 3; ++k) EXPECT_EQ(piece.end[k], piece.position[k] + glm::dvec3(0, 64, 0));
}

Scene painted_ground() {
  Scene scene = ground_scene(1e6f);
  Mesh& mesh = scene.meshes[0];
  mesh.normals = {{0, 1, 0}, {0.6f, 0.8f, 0}, {0, 0.8f, 0.6f}, {0, 1, 0}};
  mesh.primitives[0].has_normals = true;
  mesh.colors = {{0, 0, 0, 1}, {1, 0, 0, 1}, {1, 1, 0, 1}, {0, 1, 0, 1}};
  mesh.uvs[0] = {{0, 0}, {2e6f, 0}, {2e6f, 2e6f}, {0, 2e6f}}; // a tile a metre
  scene.images.push_back({"tile", 1, 1, {255, 255, 255, 255}, {}});
  scene.materials[0].base_color_texture.image = 0;
  return scene;
}

TEST(CutScene, AttributesAreThoseOfTheTriangle) {
  Scene scene = painted_ground();
  const PackedScene packed = pack(scene, {.eye = glm::dvec3(0.25, 1.7, 0.5), .near = {{0.25, 1.7, 0.5}}});
  EXPECT_EQ(packed.cut.triangles, 2u);
  EXPECT_EQ(packed.triangles.size(), packed.cut.pieces);
  bool close = false;
  for (std::size_t t = 0; t < packed.triangles.size(); ++t) {
    const gpu::Triangle& triangle = packed.triangles[t];
    EXPECT_LT(packed.source_id(static_cast<std::uint32_t>(t)), 2u);
    const glm::vec3 corners[3] = {triangle.v0, triangle.v1, triangle.v2};
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = packed.triangle_vertices[t][k];
      const glm::dvec3 p = glm::dvec3(corners[k]) + packed.origin;
      const double u = p.x + 1e6, w = 1e6 - p.z; // uv of the place
      const glm::vec4 color = packed.vertex_colors[v];
      EXPECT_NEAR(color.r, u / 2e6, 1e-6);
      EXPECT_NEAR(color.g, w / 2e6, 1e-6);
      // A whole pair of tiles may be missing; near the eye the rest is exact to a thousandth.
      const double du = (u - packed.vertex_uvs[v].x) / 2.0, dw = (w - packed.vertex_uvs[v].y) / 2.0;
      const double fine = 1e-6 * (1.0 + glm::length(p - packed.origin));
      EXPECT_NEAR(du, std::round(du), fine);
      EXPECT_NEAR(dw, std::round(dw), fine);
      close = close || glm::length(p - packed.origin) < 3.0;
    }
  }
  EXPECT_TRUE(close);
}

TEST(CutScene, IdsOfOtherTrianglesStay) {
  Scene scene = ground_scene(1e6f);
  add_instance(scene, add_mesh(scene, kUnitTriangle));
  const PackedScene packed = pack(scene, {.near = {{0.2, 1.7, 0.1}}});
  std::map<std::uint32_t, int> ids;
  for (const gpu::Triangle& triangle : packed.triangles) ++ids[triangle.id];
  for (const std::uint32_t id : {0u, 1u, 2u}) EXPECT_EQ(ids[id], 1);
  EXPECT_EQ(ids.size(), packed.triangles.size());
}

TEST(CutScene, LightIsKept) {
  const auto power_of = [](const std::vector<glm::dvec3>& near) {
    Scene scene = ground_scene(1e4f);
    scene.materials[0].emission = glm::vec3(2.0f);
    const PackedScene packed = pack(scene, {.near = near, .lights = gpu::kLightsPower});
    double probability = 0.0, area = 0.0;
    for (const gpu::Light& light : packed.lights) {
      probability += light.probability;
      area += light.probability / light.pdf_area;
    }
    EXPECT_NEAR(probability, 1.0, 1e-6);
    EXPECT_NEAR(area / 4e8, 1.0, 1e-5);
    for (const gpu::Triangle& triangle : packed.triangles) EXPECT_NE(triangle.light, gpu::kNone);
    return packed.lights.size();
  };
  EXPECT_EQ(power_of({}), 2u);
  EXPECT_GT(power_of({{0.1, 1.5, 0.2}}), 100u);
}

TEST(CutScene, SharedMeshesAreCutWhereOneOfThemIsNear) {
  Scene scene = ground_scene(1e5f);
  add_instance(scene, 0, glm::translate(glm::dmat4(1.0), glm::dvec3(0.0, -3e4, 0.0)));
  EXPECT_EQ(pack(scene, {.near = {{0.0, 1.7, 0.0}}}).cut.triangles, 2u);
  EXPECT_EQ(pack(scene, {.near = {{0.0, 1.7 - 3e4, 0.0}}}).cut.triangles, 2u);
  EXPECT_EQ(pack(scene, {.near = {{0.0, 5e4, 0.0}}}).cut.triangles, 0u);

  // Near the eye the coordinates of the object are fine, wherever the mesh has its zero.
  for (glm::vec3& p : scene.meshes[0].positions) p += glm::vec3(1e6f, 0.0f, 2e6f);
  for (Instance& instance : scene.instances)
    instance.world_from_object = glm::translate(instance.world_from_object, glm::dvec3(-1e6, 0.0, -2e6));
  const PackedScene packed = pack(scene, {.eye = glm::dvec3(0.0, 1.7, 0.0), .near = {{0.0, 1.7, 0.0}}});
  float nearest = 1e30f;
  for (const gpu::Triangle& triangle : packed.triangles) nearest = std::min(nearest, glm::length(triangle.v0));
  EXPECT_LT(nearest, 3.0f);
  EXPECT_EQ(packed.triangle_count, 4u);
  for (const gpu::Instance& instance : packed.instances)
    EXPECT_LT(std::abs(instance.world_from_object[0].w) + std::abs(instance.world_from_object[2].w), 1.0f);
}

TEST(CutScene, IsPlannedAndTheSameEachTime) {
  Scene scene = painted_ground();
  const Packing packing{.eye = glm::dvec3(7.0, 1.7, 3.0), .near = {{7.0, 1.7, 3.0}}};
  const PackedScene a = pack(scene, packing), b = pack(scene, packing);
  ASSERT_EQ(a.triangles.size(), b.triangles.size());
  for (std::size_t i = 0; i < a.triangles.size(); ++i) {
    EXPECT_EQ(a.triangles[i].v0, b.triangles[i].v0);
    EXPECT_EQ(a.triangles[i].id, b.triangles[i].id);
  }
  const ScenePlan planned = plan(scene, packing);
  EXPECT_EQ(planned.triangle_bytes, a.triangles.size() * (sizeof(gpu::Triangle) + sizeof(glm::uvec4)));
  EXPECT_EQ(planned.vertex_bytes,
            (a.vertex_normals.size() + a.vertex_uvs.size() + a.vertex_colors.size()) * sizeof(glm::vec4));
}

} // namespace
} // namespace wavepath
