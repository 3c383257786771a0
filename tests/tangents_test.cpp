// Tangents made for normal maps.
#include <cmath>
#include <cstdlib>
#include <iterator>

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

// KHR_texture_transform, of the map itself and of layers that are read by other coordinates.
TEST(Tangents, GoByTheCoordinatesThatTexturesAreReadWith) {
  const float c = std::cos(0.7f), s = std::sin(0.7f);
  const glm::mat2 turned(0.0f, -1.0f, 1.0f, 0.0f), oblique(c, -s, s, c), flipped_u(-2.0f, 0.0f, 0.0f, 1.0f),
      flipped_v(1.0f, 0.0f, 0.0f, -1.0f), both(-1.0f, 0.0f, 0.0f, -3.0f), large(1e20f, 0.0f, 0.0f, 1e20f),
      smeared(0.0f, 0.0f, 0.0f, 1.0f), turned_and_smeared(0.0f, -1.0f, 0.0f, 0.0f), point(0.0f);
  struct Case {
    glm::mat2 matrix;
    glm::dvec3 tangent;
    float handedness;
  };
  for (const Case& k :
       {Case{glm::mat2(1.0f), {1, 0, 0}, 1.0f}, Case{turned, {0, -1, 0}, 1.0f}, Case{oblique, {c, -s, 0}, 1.0f},
        Case{flipped_u, {-1, 0, 0}, -1.0f}, Case{flipped_v, {1, 0, 0}, -1.0f}, Case{both, {-1, 0, 0}, 1.0f},
        Case{large, {1, 0, 0}, 1.0f}, Case{smeared, {1, 0, 0}, 1.0f}, Case{turned_and_smeared, {0, -1, 0}, 1.0f},
        Case{point, {1, 0, 0}, 1.0f}}) {
    Material m;
    m.normal_texture.image = m.coat_normal_texture.image = m.anisotropy_texture.image = 0;
    m.coat = m.anisotropy = 1.0f;
    Mesh mesh = quad(false);
    mesh.uvs[1] = quad(true).uvs[0];
    m.normal_texture.uv_matrix = k.matrix;
    m.normal_texture.uv_offset = {3.0f, -7.0f};
    m.coat_normal_texture.uv_set = 1;
    m.anisotropy_texture.uv_matrix = k.matrix;
    add_tangents(mesh, m);
    ASSERT_EQ(mesh.tangents.size(), 4u);
    ASSERT_EQ(mesh.layer_tangents[kCoatTangents].size(), 4u);
    EXPECT_TRUE(mesh.layer_tangents[kGrainTangents].empty()); // it is read as the normal map
    for (std::size_t v = 0; v < 4; ++v) {
      expect_near(glm::vec3(mesh.tangents[v]), k.tangent, 1e-6);
      EXPECT_EQ(mesh.tangents[v].w, k.handedness);
      EXPECT_EQ(mesh.layer_tangents[kCoatTangents][v], glm::vec4(-1, 0, 0, -1)); // TEXCOORD_1 is mirrored
    }
  }
}

TEST(Tangents, OfAllLayersAreSplitWithTheirVertices) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.uvs[0] = {{0, 1}, {0, 0}, {1, 1}, {-1, 1}};
  mesh.uvs[1] = {{0, 1}, {0, 0}, {1, 1}, {1, 1}}; // mirrored at the edge
  mesh.indices = {0, 2, 1, 0, 1, 3};
  Material m;
  m.normal_texture.image = m.coat_normal_texture.image = 0;
  m.coat_normal_texture.uv_set = 1;
  add_tangents(mesh, m);
  ASSERT_EQ(mesh.positions.size(), 6u);
  ASSERT_EQ(mesh.tangents.size(), 6u);
  ASSERT_EQ(mesh.layer_tangents[kCoatTangents].size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(mesh.tangents[mesh.indices[i]], glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(mesh.layer_tangents[kCoatTangents][mesh.indices[i]],
              i < 3 ? glm::vec4(1, 0, 0, 1) : glm::vec4(-1, 0, 0, -1));
  }
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

// A bumpy sheet of 5 x 5 vertices, its texture mirrored at the middle, sheared and uneven, its normals tilted at
// random, its diagonals in both directions.
Mesh bumpy_sheet() {
  constexpr int kSide = 5;
  Mesh mesh;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      mesh.positions.emplace_back(i, j, (i * 7 + j * j * 5 + i * j * 3) % 8 / 8.0);
      const double a = (i * 3 + j * 5) % 7 / 8.0 - 0.375, b = (i * 5 + j * 2) % 7 / 8.0 - 0.375;
      mesh.normals.emplace_back(glm::normalize(glm::dvec3(a, b, 1.0)));
      mesh.uvs[0].emplace_back(std::abs(i - 2) / 4.0 + j / 16.0, (j + (i * j) % 3 / 8.0) / 4.0);
    }
  for (std::uint32_t j = 0; j + 1 < kSide; ++j)
    for (std::uint32_t i = 0; i + 1 < kSide; ++i) {
      const std::uint32_t a = j * kSide + i, b = a + 1, c = a + kSide, d = c + 1;
      const std::uint32_t corners[2][6] = {{a, b, c, b, d, c}, {a, b, d, a, d, c}};
      mesh.indices.insert(mesh.indices.end(), std::begin(corners[(i + j) % 2]), std::end(corners[(i + j) % 2]));
    }
  return mesh;
}

// What Mikkelsen's own code makes of that sheet (mikktspace 1.1.1, with the sign of glTF): a vertex of the mesh, and
// the tangent of its corners of each handedness.
const struct {
  std::uint32_t vertex;
  glm::vec4 tangent;
} kMikkelsen[] = {
    {0, {-0.9147335f, -0.1167745f, -0.3868155f, 1.0f}},  {1, {-0.9981990f, 0.0581985f, -0.0145496f, 1.0f}},
    {2, {-0.9363291f, 0.0000000f, 0.3511235f, 1.0f}},    {2, {0.9363292f, 0.0000000f, -0.3511235f, -1.0f}},
    {3, {0.9916853f, 0.0152681f, 0.1277777f, -1.0f}},    {4, {0.9727437f, -0.0389098f, -0.2285948f, -1.0f}},
    {5, {-0.9668956f, 0.0566479f, 0.2488049f, 1.0f}},    {6, {-0.9511589f, 0.2783940f, -0.1333920f, 1.0f}},
    {7, {-0.9923072f, 0.0009716f, 0.1237955f, 1.0f}},    {7, {0.9802911f, 0.1242461f, -0.1535979f, -1.0f}},
    {8, {0.9343089f, 0.0656561f, 0.3503658f, -1.0f}},    {9, {0.9944355f, -0.1022013f, -0.0255503f, -1.0f}},
    {10, {-0.9802650f, 0.1961617f, -0.0245202f, 1.0f}},  {11, {-0.9371265f, -0.0293494f, 0.3477537f, 1.0f}},
    {12, {-0.9394362f, -0.2653324f, -0.2169292f, 1.0f}}, {12, {0.9931316f, -0.0283051f, 0.1135270f, -1.0f}},
    {13, {0.9717269f, -0.0433521f, -0.2320937f, -1.0f}}, {14, {0.9237164f, -0.3056464f, 0.2309291f, -1.0f}},
    {15, {-0.9695330f, 0.0066335f, -0.2448709f, 1.0f}},  {16, {-0.9923953f, 0.0152676f, 0.1221410f, 1.0f}},
    {17, {-0.9365453f, 0.0056251f, -0.3505013f, 1.0f}},  {17, {0.9354879f, 0.0170971f, 0.3529451f, -1.0f}},
    {18, {1.0000000f, 0.0000000f, 0.0000000f, -1.0f}},   {19, {0.9358527f, -0.1707585f, -0.3082551f, -1.0f}},
    {20, {-0.9396429f, -0.0687544f, 0.3351775f, 1.0f}},  {21, {-0.9858282f, 0.0735094f, -0.1507946f, 1.0f}},
    {22, {-0.9580053f, 0.1886980f, 0.2159141f, 1.0f}},   {22, {0.9424200f, 0.2082977f, -0.2616422f, -1.0f}},
    {23, {0.9701470f, -0.0001505f, 0.2425179f, -1.0f}},  {24, {0.9926347f, 0.0729412f, -0.0967264f, -1.0f}}};

TEST(Tangents, AreThoseOfMikkelsensCode) {
  const Mesh sheet = bumpy_sheet();
  Mesh mesh = sheet;
  generate_tangents(mesh, mesh.uvs[0]);
  std::size_t seen = 0;
  for (const auto& [vertex, expected] : kMikkelsen) {
    bool found = false;
    for (std::size_t i = 0; i < sheet.indices.size(); ++i) { // corner by corner: vertices may have been split
      const glm::vec4 tangent = mesh.tangents[mesh.indices[i]];
      if (sheet.indices[i] != vertex || tangent.w != expected.w) continue;
      EXPECT_LT(glm::length(glm::vec3(tangent - expected)), 1e-6f) << "corner " << i << " at vertex " << vertex;
      found = true;
      ++seen;
    }
    EXPECT_TRUE(found) << "vertex " << vertex << " has no corner of handedness " << expected.w;
  }
  EXPECT_EQ(seen, sheet.indices.size());
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
