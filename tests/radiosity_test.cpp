// Radiosity: form factors of squares that have closed forms, the closed furnace, energy, links, agreement with path
// tracing in a diffuse room as patches shrink, lamps that are no surfaces, surfaces without cracks at T-vertices, and
// the bits of a solution that is kept for other views.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/film/film.h"
#include "host/integrators/path/kind.h"
#include "host/integrators/radiosity/adaptive_patches.h"
#include "host/integrators/radiosity/hemicube.h"
#include "host/integrators/radiosity/kind.h"
#include "host/integrators/radiosity/links.h"
#include "host/integrators/radiosity/point_form_factor.h"
#include "host/integrators/radiosity/settings.h"
#include "host/render/render.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/hit_surface.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/scene_builder.h"
#include "tests/shared_kernels.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

const std::string kScenes = std::string(WAVEPATH_SOURCE_DIR) + "/scenes/";

// Both triangles of the parallelogram at `corner`, whose front is on the side of cross(a, b).
std::vector<glm::vec3> square(const glm::vec3& corner, const glm::vec3& a, const glm::vec3& b) {
  return {corner, corner + a, corner + a + b, corner, corner + a + b, corner + b};
}

std::uint32_t add_material(Scene& scene, float reflectance, float emission) {
  Material material = plain_material();
  material.base_color = glm::vec4(glm::vec3(reflectance), 1.0f);
  material.emission = glm::vec3(emission);
  material.double_sided = false;
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

void add_square(Scene& scene, std::uint32_t material, const glm::vec3& corner, const glm::vec3& a, const glm::vec3& b) {
  add_instance(scene, add_mesh(scene, square(corner, a, b), material));
}

// A unit square that shines upwards, and a black one that `place` adds.
Scene two_squares(const glm::vec3& corner, const glm::vec3& a, const glm::vec3& b) {
  Scene scene;
  scene.path = "test";
  add_square(scene, add_material(scene, 0.0f, 1.0f), {0, 0, 0}, {0, 0, 1}, {1, 0, 0});
  add_square(scene, add_material(scene, 0.0f, 0.0f), corner, a, b);
  return scene;
}

// The walls of the unit cube, seen from inside.
void add_walls(Scene& scene, std::uint32_t material) {
  add_square(scene, material, {0, 0, 0}, {0, 0, 1}, {1, 0, 0});
  add_square(scene, material, {0, 1, 0}, {1, 0, 0}, {0, 0, 1});
  add_square(scene, material, {0, 0, 0}, {0, 1, 0}, {0, 0, 1});
  add_square(scene, material, {1, 0, 0}, {0, 0, 1}, {0, 1, 0});
  add_square(scene, material, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_square(scene, material, {0, 0, 1}, {0, 1, 0}, {1, 0, 0});
}

Camera camera_inside() {
  Camera camera;
  camera.yfov = 2.0;
  camera.world_from_camera = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0.5, 0.4, 0.7, 1}};
  return camera;
}

struct RadiositySubject {
  PackedScene packed;
  View view;

  RadiositySubject(Scene scene, const RenderPlan& settings)
      : packed(pack(scene)), view(resolve_view(scene, {}, settings.width, settings.height)) {}
};

RenderPlan plan_of(const IntegratorKind* integrator, std::uint32_t spp, std::uint32_t patches) {
  RenderPlan settings;
  settings.width = settings.height = 24;
  settings.last_sample = spp;
  settings.integrator = integrator;
  settings.patches = patches;
  settings.patch_rays = 64;
  return settings;
}

class RadiosityTest : public VulkanTest {
protected:
  RenderResult render(const RadiositySubject& subject, const RenderPlan& settings) {
    return wavepath::render(device(), subject.packed, subject.view, settings, {}, shared_kernels(device()));
  }
  RenderResult render(Scene scene, const RenderPlan& settings) {
    return render(RadiositySubject(std::move(scene), settings), settings);
  }
};

double mean_of(const Picture& picture) {
  double sum = 0.0;
  for (std::size_t c = 0; c < 3; ++c)
    for (const float value : picture.channels[c].values) sum += value;
  return sum / (3.0 * static_cast<double>(picture.channels[0].values.size()));
}

// Root of relMSE, which no lamp dominates.
double difference_of(const Picture& a, const Picture& b) {
  double squares = 0.0;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < a.channels[c].values.size(); ++i) {
      const double truth = b.channels[c].values[i];
      squares += std::pow(a.channels[c].values[i] - truth, 2.0) / (truth * truth + 0.01);
    }
  return std::sqrt(squares / (3.0 * static_cast<double>(a.channels[0].values.size())));
}

// ---- without a device -----------------------------------------------------------------------------------------------

// The view factor of a square of side 2 at distance 1 (Howell's catalogue B-4, four times), which is that of the top
// face.
TEST(Hemicube, DeltaFormFactorsAreThoseOfPixels) {
  const double corner = std::atan(1.0 / std::sqrt(2.0)) / (std::sqrt(2.0) * std::numbers::pi);
  for (const std::uint32_t side : {16u, 64u}) {
    const std::vector<double> factors = delta_form_factors(side);
    ASSERT_EQ(factors.size(), 3 * side * side);
    double top = 0.0, all = 0.0;
    for (std::size_t i = 0; i < factors.size(); ++i) (i < side * side ? top : all) += factors[i];
    EXPECT_NEAR(top + all, 1.0, 1e-12);
    EXPECT_NEAR(top, 4.0 * corner, 0.4 / (side * side));
  }
}

// Two faces that send all their light to each other: B = E / (1 - r1 r2), by hand.
TEST(Refinement, ShootsUntilLittleIsLeft) {
  std::vector<Face> faces(2);
  faces[0] = {.area = 1.0, .reflectance = glm::dvec3(0.5), .unshot = glm::dvec3(3.0, 2.0, 1.0)};
  faces[1] = {.area = 2.0, .reflectance = glm::dvec3(0.8)};
  Refinement refinement(faces, 1000.0);
  while (true) {
    const std::vector<Shot> shots = refinement.next_shots(1);
    if (shots.empty()) break;
    for (const Shot& shot : shots) refinement.receive(1 - shot.face, shot.power);
  }
  EXPECT_LE(refinement.remaining(), Refinement::kRemaining);
  EXPECT_GT(refinement.remaining(), 0.0);
  EXPECT_LT(refinement.shots(), 30u);
  const std::vector<glm::dvec3> light = refinement.irradiance();
  EXPECT_NEAR(light[1].r, 3.0 / (1.0 - 0.4) / 2.0, 2e-3);
  EXPECT_NEAR(light[0].g, 2.0 * 0.8 / (1.0 - 0.4), 4e-3);
  EXPECT_NEAR(refinement.absorbed(light), 1.0, 1e-3) << "all of it, with the ambient term";
}

struct FormFactorCase {
  const char* name;
  glm::vec3 corner, a, b;
  double factor;
};

// Howell's catalogue, C-11 and C-14, of unit squares at distance 1 and with a common edge.
const FormFactorCase kFormFactorCases[] = {{"parallel", {0, 1, 0}, {1, 0, 0}, {0, 0, 1}, 0.1998249},
                                           {"perpendicular", {0, 0, 0}, {0, 1, 0}, {0, 0, 1}, 0.2000438}};

// Howell's catalogue, B-4: a rectangle that faces the point, which is below one of its corners.
TEST(Links, PointFormFactorsAreThoseOfTheCatalogue) {
  const double a = 0.7, b = 1.9; // sides over distance
  const auto part = [](double x, double y) { return x / std::sqrt(1 + x * x) * std::atan(y / std::sqrt(1 + x * x)); };
  const double expected = (part(a, b) + part(b, a)) / (2.0 * std::numbers::pi);
  const glm::dvec3 at(3.0, -2.0, 5.0), up(0, 0, 1), p = at + 2.0 * up, x(2 * a, 0, 0), y(0, 2 * b, 0);
  EXPECT_NEAR(point_form_factor(at, up, {p, p + x, p + x + y}) + point_form_factor(at, up, {p, p + x + y, p + y}),
              expected, 1e-14);
  EXPECT_EQ(point_form_factor(at, -up, {p, p + x, p + x + y}), 0.0) << "below the horizon";
  // Half of a wide wall that stands on the horizon, which goes on below it: half of the hemisphere.
  const glm::dvec3 wall = at + glm::dvec3(1e-6, -1e3, -1e3);
  const glm::dvec3 wide(0, 2e3, 0), high(0, 0, 2e3);
  EXPECT_NEAR(point_form_factor(at, up, {wall, wall + wide, wall + wide + high}) +
                  point_form_factor(at, up, {wall, wall + wide + high, wall + high}),
              0.5, 1e-5);
  EXPECT_EQ(point_form_factor(at, up, {at, at + x, at + x + y}), 0.0) << "in one plane";
}

// Solves links of a scene without a device: nothing stands between. `at_once`: how many are measured together.
Links unshadowed_links(const PackedScene& packed, std::uint32_t patches, std::vector<Face> faces, std::uint64_t most,
                       std::uint64_t at_once = 100) {
  Links links(make_link_nodes(packed, uniform_patches(packed, patches), false), std::move(faces), most);
  for (auto next = links.next(at_once); !next.empty(); next = links.next(at_once))
    links.measure(std::vector<float>(next.size(), 1.0f));
  return links;
}

std::vector<Face> faces_of(const PackedScene& packed, std::uint32_t patches) {
  const PatchTree tree = uniform_patches(packed, patches);
  std::vector<Face> faces;
  for (const double area : make_mesh(packed, tree).areas) faces.insert(faces.end(), 2, Face{.area = area});
  return faces;
}

TEST(Links, ExchangeOfSquaresIsThatOfTheCatalogue) {
  for (const FormFactorCase& one : kFormFactorCases) {
    SCOPED_TRACE(one.name);
    Scene scene = two_squares(one.corner, one.a, one.b);
    const PackedScene packed = pack(scene);
    const std::vector<LinkNode> nodes = make_link_nodes(packed, uniform_patches(packed, 256), false);
    double all = 0.0; // of the leaves
    for (std::uint32_t a = 0; a < nodes.size(); ++a)
      for (std::uint32_t b = a + 1; b < nodes.size(); ++b)
        for (std::uint32_t sides = 0; sides < 4; ++sides)
          if (nodes[a].first_child == 0 && nodes[b].first_child == 0)
            all += exchange_of(nodes, 2 * a + (sides & 1), 2 * b + (sides >> 1)).area;
    EXPECT_NEAR(all, one.factor, 2e-4);
  }
}

// Mean form factor of a triangle with normal +x, by 576 points.
double mean_factor(const std::array<glm::dvec3, 3>& from, const std::array<glm::dvec3, 3>& to) {
  constexpr int kSteps = 24;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < 2 * (kSteps - i) - 1; ++j) { // every second one stands on its head
      const double u = (i + (j % 2 ? 2.0 : 1.0) / 3.0) / kSteps, v = (j / 2 + (j % 2 ? 2.0 : 1.0) / 3.0) / kSteps;
      sum += point_form_factor(from[0] + u * (from[1] - from[0]) + v * (from[2] - from[0]), {1, 0, 0}, to);
    }
  return sum / (kSteps * kSteps);
}

// A dark square is lit by another one. Links end where the light is right, so more of them have less error.
TEST(Links, AreCutWhereLightWouldBeWrong) {
  Scene scene = two_squares({0, 0, 0}, {0, 1, 0}, {0, 0, 1});
  const PackedScene packed = pack(scene);
  const PatchTree tree = uniform_patches(packed, 512), whole = uniform_patches(packed, 1);
  const auto is_lamp = [&](const gpu::Patch& patch) { // the one that lies
    return std::abs(geometric_normal(packed, {patch.triangle, patch.instance, 0.25f, 0.25f}).y) > 0.5;
  };
  std::vector<Face> faces = faces_of(packed, 512);
  for (std::uint32_t i = 0; i < tree.size(); ++i)
    if (is_lamp(tree.patches[i])) faces[2 * i].unshot = glm::dvec3(1.0);
  double before = 1.0;
  for (const std::uint64_t most : {16u, 64u, 512u, 4096u}) {
    const Links links = unshadowed_links(packed, 512, faces, most);
    EXPECT_LE(links.measured(), most + 4) << "four pairs of triangles face each other";
    EXPECT_GT(links.measured(), most / 2);
    EXPECT_EQ(unshadowed_links(packed, 512, faces, most, 7).irradiance(), links.irradiance());
    const std::vector<glm::dvec3> light = links.irradiance();
    double squares = 0.0, lit = 0.0;
    for (std::uint32_t i = 0; i < tree.size(); ++i) {
      if (is_lamp(tree.patches[i])) continue;
      double expected = 0.0;
      for (const gpu::Patch& lamp : whole.patches)
        if (is_lamp(lamp)) expected += mean_factor(corners_of(packed, tree.patches[i]), corners_of(packed, lamp));
      squares += std::pow(light[2 * i].r - expected, 2.0);
      lit += expected * expected;
    }
    const double error = std::sqrt(squares / lit);
    RecordProperty("error_" + std::to_string(most), std::to_string(error));
    if (most <= 512)
      EXPECT_LT(error, 0.6 * before) << most;
    else // the lamp is cut too, as links do not know that nothing stands between
      EXPECT_LT(error, 5e-3);
    before = error;
  }
}

// A lamp outside lights no wall. Faces that send nothing to each other keep the links of whole triangles.
TEST(Links, AreNotCutInTheDark) {
  Scene scene;
  scene.path = "test";
  add_walls(scene, add_material(scene, 0.5f, 0.0f));
  const PackedScene packed = pack(scene);
  std::vector<Face> faces = faces_of(packed, 1000);
  EXPECT_EQ(unshadowed_links(packed, 1000, faces, 1u << 20).measured(), 0u) << "there is no light at all";
  faces[1].unshot = glm::dvec3(1.0); // the outside of a wall
  EXPECT_EQ(unshadowed_links(packed, 1000, faces, 1u << 20).measured(), 60u)
      << "each of 12 triangles sees the ten of other walls";
}

// B = E / (1 - r) of a closed furnace, also where nearly all is reflected and few links are inexact: light must not
// grow for ever, nor may the limit that prevents it take much.
TEST(Links, KeepTheLightOfWhiteWalls) {
  Scene scene;
  scene.path = "test";
  add_walls(scene, add_material(scene, 1.0f, 1.0f));
  const PackedScene packed = pack(scene);
  for (const double reflectance : {0.5, 0.99, 1.0})
    for (const std::uint64_t more : {0u, 1000u, 10000u}) {
      SCOPED_TRACE(std::to_string(reflectance) + " with " + std::to_string(more));
      std::vector<Face> faces = faces_of(packed, 300);
      for (Face& face : faces) face.reflectance = glm::dvec3(reflectance), face.unshot = glm::dvec3(1.0);
      const Links links = unshadowed_links(packed, 300, faces, more);
      const std::vector<glm::dvec3> light = links.irradiance();
      double power = 0.0, area = 0.0, most = 0.0;
      for (std::size_t i = 0; i < light.size(); ++i)
        if (light[i].r > 0.0)
          power += faces[i].area * light[i].r, area += faces[i].area, most = std::max(most, light[i].r);
      EXPECT_NEAR(area, 6.0, 1e-9) << "all walls, from inside";
      EXPECT_LE(most, 1.05 / (1.0 - 0.9995)) << "what weakened links leave";
      const double expected = 1.0 / (1.0 - reflectance);
      if (reflectance == 0.5) {
        EXPECT_NEAR(power / area, expected, 0.01 * expected);
      }
      if (reflectance == 0.99) {
        EXPECT_NEAR(power / area, expected, 0.1 * expected);
      }
    }
}

// A box that stands a little out of a large floor: points of its sides that the quadrature takes are below the floor.
TEST(Links, FacesOfASunkenBoxSeeTheFloor) {
  Scene scene;
  scene.path = "test";
  const std::uint32_t material = add_material(scene, 0.5f, 0.0f);
  add_square(scene, material, {-5, 0, -5}, {0, 0, 10}, {10, 0, 0});
  add_square(scene, material, {0, -0.95f, 0}, {0, 1, 0}, {0, 0, 1});
  const PackedScene packed = pack(scene);
  const std::vector<LinkNode> nodes = make_link_nodes(packed, uniform_patches(packed, 1), false);
  std::size_t linked = 0;
  for (std::uint32_t floor = 0; floor < nodes.size(); ++floor)
    for (std::uint32_t wall = 0; wall < nodes.size(); ++wall)
      if (nodes[floor].normal.y > 0.5 && std::abs(nodes[wall].normal.x) > 0.5)
        for (std::uint32_t side = 0; side < 2; ++side) {
          const double area = exchange_of(nodes, 2 * floor, 2 * wall + side).area;
          linked += area > 0.0;
          EXPECT_LT(area, 0.1) << "half of what stands out, 0.05";
        }
  EXPECT_EQ(linked, 8u) << "both sides of the wall and the upper one of the floor, of two triangles each";
}

TEST(Links, OneSidedTrianglesHaveNoBackIfRaysPassIt) {
  Scene scene = two_squares({0, 1, 0}, {1, 0, 0}, {0, 0, 1});
  const PackedScene packed = pack(scene);
  const PatchTree tree = uniform_patches(packed, 1);
  for (const bool culls : {false, true})
    for (const LinkNode& node : make_link_nodes(packed, tree, culls)) EXPECT_EQ(node.has_back, !culls);
}

TEST(Patches, HaveOneSizeAndAllOfTheArea) {
  Scene scene;
  scene.path = "test";
  add_walls(scene, add_material(scene, 0.5f, 0.0f));
  add_square(scene, 0, {2, 0, 0}, {0, 0, 4}, {4, 0, 0}); // 16 times the area of a wall
  const PackedScene packed = pack(scene);
  const PatchTree tree = uniform_patches(packed, 2000);
  EXPECT_LE(tree.size(), 2000u);
  EXPECT_GT(tree.size(), 500u);
  const PatchMesh mesh = make_mesh(packed, tree);
  double sum = 0.0;
  for (const double area : mesh.areas) {
    EXPECT_NEAR(area, mesh.areas[0], 1e-9 * area);
    sum += area;
  }
  EXPECT_NEAR(sum, 22.0, 1e-9);
  EXPECT_TRUE(mesh.hanging.empty());
}

// Wherever a corner of one patch is in the middle of the side of another, light there is the mean of that side's ends.
// The middle of such an edge rounds to one of its ends, which must not hang on itself.
TEST(Patches, EdgesTooShortForAMiddleHaveNone) {
  Scene scene;
  scene.path = "test";
  const std::uint32_t material = add_material(scene, 0.5f, 0.0f);
  add_walls(scene, material);
  for (int i = 0; i < 8; ++i) { // about as wide as floats there are apart
    glm::dmat4 place(1.0);
    place[3] = {0.8, 0.1 * i, 0.25, 1.0};
    const float width = 1e-8f * static_cast<float>(i + 2);
    add_instance(scene, add_mesh(scene, {{0, 0, 0}, {width, 0, 0}, {0, 0, 0.5f}}, material), place);
  }
  const PackedScene packed = pack(scene);
  const PatchMesh mesh = make_mesh(packed, uniform_patches(packed, 20));
  ASSERT_GT(mesh.areas.size(), 14u);
  for (const HangingVertex& one : mesh.hanging) {
    EXPECT_NE(one.vertex, one.a);
    EXPECT_NE(one.vertex, one.b);
  }
}

TEST(Patches, HaveNoCracksAtTVertices) {
  Scene scene;
  scene.path = "test";
  add_walls(scene, add_material(scene, 0.5f, 0.0f));
  const PackedScene packed = pack(scene);
  PatchTree tree = uniform_patches(packed, 48);
  PatchMesh mesh = make_mesh(packed, tree);
  std::vector<Face> faces(2 * tree.size(), {.area = 1.0, .reflectance = glm::dvec3(0.5)});
  std::vector<glm::vec4> corners(3 * faces.size(), glm::vec4(0.0f));
  corners[3] = corners[60] = corners[120] = glm::vec4(1.0f); // light changes on few patches
  refine(tree, mesh, faces, corners, 400);
  EXPECT_GT(tree.size(), 390u);
  EXPECT_LE(tree.size(), 400u);
  mesh = make_mesh(packed, tree);
  EXPECT_GT(mesh.hanging.size(), 20u);
  std::vector<glm::dvec3> light;
  for (std::uint32_t i = 0; i < 2 * tree.size(); ++i) light.emplace_back(std::fmod(i * 0.618034, 1.0), 0.0, 0.0);
  corners = light_at_corners(mesh, light);
  // By place, and by the direction of the wall.
  using Key = std::array<double, 6>;
  const auto key = [&](const glm::dvec3& p, const std::array<glm::dvec3, 3>& patch) {
    const glm::dvec3 n = glm::round(glm::normalize(glm::cross(patch[1] - patch[0], patch[2] - patch[0])));
    return Key{p.x, p.y, p.z, n.x + 0.0, n.y + 0.0, n.z + 0.0};
  };
  std::map<Key, float> at;
  for (std::uint32_t patch = 0; patch < tree.size(); ++patch) {
    const std::array<glm::dvec3, 3> p = corners_of(packed, tree.patches[patch]);
    for (std::size_t i = 0; i < 3; ++i) {
      const float value = corners[6 * patch + i].r;
      const auto [one, is_new] = at.try_emplace(key(p[i], p), value);
      EXPECT_EQ(one->second, value) << "one vertex of several patches";
    }
  }
  std::size_t found = 0;
  for (std::uint32_t patch = 0; patch < tree.size(); ++patch) {
    const std::array<glm::dvec3, 3> p = corners_of(packed, tree.patches[patch]);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      const auto middle = at.find(key(0.5 * (p[i] + p[j]), p));
      if (middle == at.end()) continue;
      ++found;
      EXPECT_NEAR(middle->second, 0.5f * (corners[6 * patch + i].r + corners[6 * patch + j].r), 1e-6f);
    }
  }
  EXPECT_GT(found, 20u);
}

// ---- oracles --------------------------------------------------------------------------------------------------------

// What does not reach the other square leaves the scene.
TEST_F(RadiosityTest, FormFactorsOfSquaresAreThoseOfTheCatalogue) {
  for (const FormFactorCase& one : kFormFactorCases)
    for (const std::uint32_t by : {0u, kFormFactorsHemicube, kFormFactorsLinks}) {
      SCOPED_TRACE(std::string(one.name) + " by " + std::string(kFormFactorNames[by]));
      RenderPlan settings = plan_of(&kRadiosity, 1, 256);
      settings.form_factors = by;
      settings.patch_rays = 1024;
      const RenderResult result = render(two_squares(one.corner, one.a, one.b), settings);
      ASSERT_TRUE(result.radiosity);
      // Rays: 65536 stratified points a triangle. Hemicube: one point a patch, of 1/8 of the square's side. Links: six
      // points of the smaller part.
      EXPECT_NEAR(1.0 - result.radiosity->lost, one.factor, by == kFormFactorsHemicube ? 4e-3 : 5e-4);
    }
}

// B = E / (1 - rho) at every patch, and so in every pixel.
TEST_F(RadiosityTest, AClosedFurnaceIsEvenlyBright) {
  for (const std::uint32_t by : {0u, kFormFactorsHemicube, kFormFactorsLinks}) {
    SCOPED_TRACE(kFormFactorNames[by]);
    Scene scene;
    scene.path = "test";
    add_walls(scene, add_material(scene, 0.6f, 1.0f));
    scene.cameras.push_back(camera_inside());
    RenderPlan settings = plan_of(&kRadiosity, 4, 384);
    settings.form_factors = by;
    settings.patch_rays = 2048;
    const RenderResult result = render(std::move(scene), settings);
    const double expected = 1.0 / (1.0 - 0.6);
    EXPECT_NEAR(mean_of(result.picture), expected, 2e-3 * expected);
    // 2048 rays leave a patch and as many arrive, from all others.
    for (const float value : result.picture.channels[0].values)
      EXPECT_NEAR(value, expected, (by == kFormFactorsHemicube ? 0.06 : 0.03) * expected);
    EXPECT_NEAR(result.radiosity->absorbed, 1.0, 1e-3);
    EXPECT_LT(result.radiosity->lost, 1e-4) << "rays that begin within rounding of an edge";
  }
}

// The final gather finds the light of lamps and that of other surfaces once each.
TEST_F(RadiosityTest, AFurnaceIsAsBrightWithAFinalGather) {
  Scene scene;
  scene.path = "test";
  add_walls(scene, add_material(scene, 0.6f, 1.0f));
  scene.cameras.push_back(camera_inside());
  RenderPlan settings = plan_of(&kRadiosity, 256, 384);
  settings.gather = true;
  const double expected = 1.0 / (1.0 - 0.6);
  EXPECT_NEAR(mean_of(render(std::move(scene), settings).picture), expected, 5e-3 * expected);
}

// What lamps send is absorbed or leaves through the open side.
TEST_F(RadiosityTest, KeepsEnergyToAThousandth) {
  for (const std::uint32_t by : {0u, kFormFactorsHemicube, kFormFactorsLinks})
    for (const std::uint32_t subdivision : {0u, kSubdivisionAdaptive}) {
      RenderPlan settings = plan_of(&kRadiosity, 1, 512);
      settings.form_factors = by, settings.subdivision = subdivision;
      settings.patch_rays = 64;
      const RenderResult result = render(load_gltf(kScenes + "cornell_box.gltf", {}), settings);
      EXPECT_NEAR(result.radiosity->absorbed + result.radiosity->lost, 1.0, 1e-3);
      EXPECT_NEAR(result.radiosity->lost, 0.30, 0.015) << "what leaves through the open side, by all methods";
    }
}

TEST_F(RadiosityTest, ComesCloserToPathTracingAsPatchesShrink) {
  RenderPlan path = plan_of(&kPath, 1024, 0);
  path.max_depth = 64;
  path.filter = gpu::kFilterBox;
  const RadiositySubject room(load_gltf(kScenes + "cornell_box.gltf", {}), path);
  const Picture truth = render(room, path).picture;
  RenderPlan radiosity = plan_of(&kRadiosity, 256, 0);
  radiosity.filter = gpu::kFilterBox;
  double before = 1.0;
  for (const std::uint32_t patches : {128u, 1024u, 8192u}) {
    radiosity.patches = patches;
    const Picture shown = render(room, radiosity).picture;
    const double difference = difference_of(shown, truth);
    RecordProperty("difference_" + std::to_string(patches), std::to_string(difference));
    EXPECT_LT(difference, 0.75 * before) << patches;
    before = difference;
  }
  radiosity.patches = 1024;
  radiosity.gather = true;
  radiosity.last_sample = 1024;
  const Picture gathered = render(room, radiosity).picture;
  EXPECT_LT(difference_of(gathered, truth), before) << "what 8192 patches show";
  EXPECT_NEAR(mean_of(gathered), mean_of(truth), 0.01 * mean_of(truth));
}

// The same room by links, of which more come closer.
TEST_F(RadiosityTest, LinksFindTheLightOfPathTracing) {
  RenderPlan path = plan_of(&kPath, 1024, 0), linked = plan_of(&kRadiosity, 256, 2048);
  path.max_depth = 64;
  path.filter = linked.filter = gpu::kFilterBox;
  linked.form_factors = kFormFactorsLinks;
  const RadiositySubject room(load_gltf(kScenes + "cornell_box.gltf", {}), path);
  const Picture truth = render(room, path).picture;
  double before = 0.15;
  for (const std::uint32_t rays : {16u, 128u}) {
    linked.patch_rays = rays;
    const RenderResult result = render(room, linked);
    const double difference = difference_of(result.picture, truth);
    RecordProperty("difference_" + std::to_string(rays), std::to_string(difference));
    EXPECT_LT(difference, 0.75 * before) << rays;
    EXPECT_NEAR(mean_of(result.picture), mean_of(truth), 0.015 * mean_of(truth));
    EXPECT_LE(result.radiosity->rays, 2048u * rays + 16u * 800u) << "and those between whole triangles";
    EXPECT_GT(result.radiosity->links, 2048u * rays / 16 / 2);
    before = difference;
  }
}

// A lamp that shines to both sides, close under the ceiling: what it sends up stays between the two. The bright part of
// the ceiling is hidden, so links of the whole ceiling would send its light into the room.
TEST_F(RadiosityTest, LinksKeepHiddenLightWhereItIs) {
  Scene scene;
  scene.path = "test";
  add_walls(scene, add_material(scene, 0.5f, 0.0f));
  const std::uint32_t lamp = add_material(scene, 0.5f, 5.0f);
  scene.materials[lamp].double_sided = true;
  add_square(scene, lamp, {0.3f, 0.998f, 0.3f}, {0.4f, 0, 0}, {0, 0, 0.4f});
  scene.cameras.push_back(camera_inside());
  RenderPlan shot = plan_of(&kRadiosity, 16, 8192), linked = shot;
  shot.patch_rays = 128;
  linked.form_factors = kFormFactorsLinks;
  const RadiositySubject room(std::move(scene), shot);
  const Picture truth = render(room, shot).picture, shown = render(room, linked).picture;
  RecordProperty("difference", std::to_string(difference_of(shown, truth)));
  RecordProperty("mean", std::to_string(mean_of(shown) / mean_of(truth)));
  // Without the range of radiosity in the choice of cuts: 0.10.
  EXPECT_LT(difference_of(shown, truth), 0.08);
  EXPECT_NEAR(mean_of(shown), mean_of(truth), 0.07 * mean_of(truth));
}

// Lamps without a surface, and a sky.
TEST_F(RadiosityTest, FindsTheLightOfLampsAndSky) {
  Scene scene;
  scene.path = "test";
  const std::uint32_t grey = add_material(scene, 0.5f, 0.0f);
  scene.materials[grey].double_sided = true;
  add_square(scene, grey, {0, 0, 0}, {0, 0, 1}, {1, 0, 0});
  add_square(scene, grey, {0, 0, 0}, {0, 1, 0}, {0, 0, 1});
  add_square(scene, grey, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  scene.lights.push_back(
      {.kind = LightKind::point, .intensity = glm::vec3(0.5f), .position = glm::dvec3(0.6, 0.7, 0.6)});
  scene.environment.radiance = glm::vec3(0.2f);
  scene.cameras.push_back(camera_inside());
  RenderPlan path = plan_of(&kPath, 256, 0), radiosity = plan_of(&kRadiosity, 32, 4096);
  path.max_depth = 64;
  path.filter = radiosity.filter = gpu::kFilterBox;
  const RadiositySubject corner(std::move(scene), path);
  const Picture truth = render(corner, path).picture;
  for (const bool gathers : {false, true}) {
    radiosity.gather = gathers;
    if (gathers) radiosity.last_sample = 256;
    const Picture shown = render(corner, radiosity).picture;
    EXPECT_NEAR(mean_of(shown), mean_of(truth), 0.01 * mean_of(truth)) << gathers;
    EXPECT_LT(difference_of(shown, truth), 0.05) << gathers;
  }
}

TEST_F(RadiosityTest, DepthOneIsDirectLight) {
  RenderPlan path = plan_of(&kPath, 256, 0), radiosity = plan_of(&kRadiosity, 64, 4096);
  path.max_depth = radiosity.max_depth = 1;
  path.filter = radiosity.filter = gpu::kFilterBox;
  const RadiositySubject room(load_gltf(kScenes + "cornell_box.gltf", {}), path);
  const Picture truth = render(room, path).picture;
  for (const bool gathers : {false, true}) {
    radiosity.gather = gathers;
    const Picture shown = render(room, radiosity).picture;
    EXPECT_LT(difference_of(shown, truth), 0.05) << gathers;
    EXPECT_NEAR(mean_of(shown), mean_of(truth), 0.02 * mean_of(truth)) << gathers;
  }
}

// ---- bits -----------------------------------------------------------------------------------------------------------

TEST_F(RadiosityTest, HowTheWorkIsCutUpDoesNotMatter) {
  RenderPlan whole = plan_of(&kRadiosity, 3, 512);
  whole.patch_rays = 16;
  whole.gather = true;
  whole.aovs = {"albedo", "normal", "depth", "emission"};
  const RadiositySubject room(load_gltf(kScenes + "cornell_box.gltf", {}), whole);
  const RenderResult expected = render(room, whole);
  for (const std::uint32_t slots : {64u, 700u}) {
    RenderPlan cut = whole;
    cut.wave_slots = slots;
    EXPECT_TRUE(*render(room, cut).film == *expected.film) << slots << " slots";
  }
  RenderPlan generic = whole;
  generic.specialize = false;
  EXPECT_TRUE(*render(room, generic).film == *expected.film) << "generic kernels";
}

TEST_F(RadiosityTest, GenericKernelsGiveLinksTheSameBits) {
  RenderPlan settings = plan_of(&kRadiosity, 2, 512);
  settings.form_factors = kFormFactorsLinks;
  settings.subdivision = kSubdivisionAdaptive;
  const RadiositySubject room(load_gltf(kScenes + "cornell_box.gltf", {}), settings);
  const RenderResult expected = render(room, settings);
  settings.specialize = false;
  EXPECT_TRUE(*render(room, settings).film == *expected.film);
}

// A mirrored node turns no front into a back: the lamp is the same square.
TEST_F(RadiosityTest, LinksOfAMirroredLampFindItsLight) {
  Scene scene;
  scene.path = "test";
  const glm::dmat4 mirrored = {{-1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {1, 0, 0, 1}};
  add_instance(scene, add_mesh(scene, square({0, 0, 0}, {0, 0, 1}, {1, 0, 0}), add_material(scene, 0.0f, 1.0f)),
               mirrored);
  add_square(scene, add_material(scene, 0.0f, 0.0f), {0, 1, 0}, {1, 0, 0}, {0, 0, 1});
  RenderPlan settings = plan_of(&kRadiosity, 1, 256);
  settings.form_factors = kFormFactorsLinks;
  EXPECT_NEAR(1.0 - render(std::move(scene), settings).radiosity->lost, kFormFactorCases[0].factor, 1e-3);
}

// Half of the light passes a sheet of which half is holes. What it stops, it gets itself.
TEST_F(RadiosityTest, LinksPassHoles) {
  Scene scene = two_squares({0, 1, 0}, {1, 0, 0}, {0, 0, 1});
  const std::uint32_t sheet = add_material(scene, 0.0f, 0.0f);
  scene.materials[sheet].base_color.a = 0.5f;
  scene.materials[sheet].alpha_mode = AlphaMode::blend;
  RenderPlan settings = plan_of(&kRadiosity, 1, 256);
  settings.form_factors = kFormFactorsLinks;
  settings.patch_rays = 1024;
  add_square(scene, sheet, {-1, 0.5f, -1}, {3, 0, 0}, {0, 0, 3});
  const double factor = point_form_factor({0.5, 0.0, 0.5}, {0, 1, 0}, {{{-1, 0.5, -1}, {2, 0.5, -1}, {2, 0.5, 2}}}) +
                        point_form_factor({0.5, 0.0, 0.5}, {0, 1, 0}, {{{-1, 0.5, -1}, {2, 0.5, 2}, {-1, 0.5, 2}}});
  const double expected = 0.5 * factor + 0.5 * kFormFactorCases[0].factor;
  settings.form_factors = 0;
  const double by_rays = 1.0 - render(RadiositySubject(scene, settings), settings).radiosity->lost;
  settings.form_factors = kFormFactorsLinks;
  const double by_links = 1.0 - render(RadiositySubject(scene, settings), settings).radiosity->lost;
  EXPECT_NEAR(by_rays, expected, 0.03) << "the factor is that of the middle";
  EXPECT_NEAR(by_links, by_rays, 0.01);
}

// Another view of the same scene shows the solution that there is, with the bits of one made for it.
TEST_F(RadiosityTest, KeepsItsSolutionForOtherViews) {
  RenderPlan settings = plan_of(&kRadiosity, 2, 512);
  settings.patch_rays = 16;
  const RadiositySubject room(load_gltf(kScenes + "cornell_box.gltf", {}), settings);
  View other = room.view;
  other.position += 0.1 * other.right;
  SceneOnDevice shared;
  shared.keeps_loop = true;
  KernelCompiler& kernels = shared_kernels(device());
  const auto shown = [&](const View& view, const RenderPlan& plan, SceneOnDevice* keeper) {
    return wavepath::render(device(), room.packed, view, plan, {}, kernels, keeper);
  };
  EXPECT_FALSE(shown(room.view, settings, &shared).radiosity->kept);
  const RenderResult walked = shown(other, settings, &shared);
  EXPECT_TRUE(walked.radiosity->kept);
  const RenderResult fresh = shown(other, settings, nullptr);
  EXPECT_FALSE(fresh.radiosity->kept);
  EXPECT_TRUE(*walked.film == *fresh.film);
  RenderPlan finer = settings;
  finer.patches = 1024;
  EXPECT_FALSE(shown(other, finer, &shared).radiosity->kept) << "another mesh";
}

// A final gather of direct light asks no patch, and depth 0 neither. Another depth then needs a solution of its own.
TEST_F(RadiosityTest, SolvesNothingThatNobodyLooksUp) {
  RenderPlan settings = plan_of(&kRadiosity, 1, 512);
  settings.patch_rays = 16;
  const RadiositySubject room(load_gltf(kScenes + "cornell_box.gltf", {}), settings);
  SceneOnDevice shared;
  shared.keeps_loop = true;
  const auto rays = [&](std::uint32_t depth, bool gather) {
    settings.max_depth = depth;
    settings.gather = gather;
    return wavepath::render(device(), room.packed, room.view, settings, {}, shared_kernels(device()), &shared)
        .radiosity->rays;
  };
  EXPECT_EQ(rays(0, false), 0u);
  EXPECT_EQ(rays(1, true), 0u);
  EXPECT_GT(rays(1, false), 1000u);
  EXPECT_GT(rays(2, true), 1000u);
}

TEST_F(RadiosityTest, RefusesGlass) {
  Scene scene = two_squares({0, 1, 0}, {1, 0, 0}, {0, 0, 1});
  scene.materials[1].transmission = 1.0f;
  EXPECT_THROW(render(std::move(scene), plan_of(&kRadiosity, 1, 64)), Error);
}

TEST_F(RadiosityTest, RefusesToLinkManyTriangles) {
  const auto scene_of = [](int squares) {
    Scene scene = two_squares({0, 1, 0}, {1, 0, 0}, {0, 0, 1});
    for (int i = 2; i < squares; ++i) add_square(scene, 1, {2 + i, 0, 0}, {0, 0, 1}, {1, 0, 0});
    return scene;
  };
  RenderPlan settings = plan_of(&kRadiosity, 1, 64);
  settings.form_factors = kFormFactorsLinks;
  EXPECT_NO_THROW(render(scene_of(512), settings));
  EXPECT_THROW(
      {
        try {
          render(scene_of(513), settings);
        } catch (const Error& error) {
          EXPECT_NE(std::string(error.what()).find("use --form-factors rays"), std::string::npos) << error.what();
          throw;
        }
      },
      Error);
  settings.form_factors = 0;
  EXPECT_NO_THROW(render(scene_of(513), settings));
}

} // namespace
} // namespace wavepath::test
