// Surface voxels and cones: against exact tests of triangles and boxes, against composition by hand, against closed
// forms and rays; and how much thin walls leak.
#include "host/integrators/hybrid/voxels/surface_voxels.h"

#include <random>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/occlusion/catalogue.h"
#include "host/integrators/hybrid/raster/placed_triangles.h"
#include "host/integrators/hybrid/voxel_settings.h"
#include "host/render/settings/integrator_kind.h"
#include "host/scene/pack/plan.h"
#include "tests/shadow_scene.h"

namespace wavepath::test {
namespace {

Scene scene_of(const std::vector<std::vector<glm::vec3>>& meshes, const glm::dmat4& placed = glm::dmat4(1.0)) {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  for (const std::vector<glm::vec3>& corners : meshes) add_instance(scene, add_mesh(scene, corners), placed);
  return scene;
}

// Whether a triangle and a closed box meet: true unless one of 13 axes separates them (Akenine-Moeller 2001).
bool meet(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& middle, double half) {
  std::array<glm::dvec3, 3> v = corners;
  for (glm::dvec3& p : v) p -= middle;
  const auto separates = [&](const glm::dvec3& axis) {
    const double a = glm::dot(axis, v[0]), b = glm::dot(axis, v[1]), c = glm::dot(axis, v[2]),
                 r = half * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
    return std::min({a, b, c}) > r || std::max({a, b, c}) < -r;
  };
  const glm::dvec3 edges[] = {v[1] - v[0], v[2] - v[1], v[0] - v[2]};
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 unit(0.0);
    unit[axis] = 1.0;
    if (separates(unit)) return false;
    for (const glm::dvec3& edge : edges)
      if (separates(glm::cross(unit, edge))) return false;
  }
  return !separates(glm::cross(edges[0], edges[1]));
}

// The levels of a scene's surface voxels, as the device made them.
struct Levels {
  SurfaceGrid grid;
  std::vector<std::uint32_t> words;

  glm::ivec3 size(std::size_t level) const { return grid.levels[level]; }
  bool contains(std::size_t level, const glm::ivec3& voxel) const {
    return glm::all(glm::greaterThanEqual(voxel, glm::ivec3(0))) && glm::all(glm::lessThan(voxel, size(level)));
  }
  std::uint32_t index(std::size_t level, const glm::ivec3& voxel) const {
    return static_cast<std::uint32_t>((voxel.z * size(level).y + voxel.y) * size(level).x + voxel.x);
  }
  bool is_marked(const glm::ivec3& voxel) const { return words[index(0, voxel) / 32] >> index(0, voxel) % 32 & 1u; }
  // 0 outside.
  glm::dvec3 opacity(std::size_t level, const glm::ivec3& voxel) const {
    if (!contains(level, voxel)) return glm::dvec3(0.0);
    if (level == 0) return glm::dvec3(is_marked(voxel) ? 1.0 : 0.0);
    const std::uint32_t word = words[grid.levels[level].w + index(level, voxel)];
    return glm::dvec3(word & 1023u, word >> 10 & 1023u, word >> 20) / 1023.0;
  }
};

template <class Visit>
void for_each_voxel(const glm::ivec3& size, Visit visit) {
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) visit(glm::ivec3(x, y, z));
}

class VoxelsTest : public ShadowTest {
protected:
  Levels levels_of(const PackedScene& packed, const View& view, std::uint32_t across) {
    RenderPlan settings;
    settings.integrator = &kAo;
    settings.width = settings.height = 8;
    Workspace workspace(device(), packed, 1024, kTraversalCompute);
    workspace.change(view, settings);
    workspace.fit(settings, packed.features);
    SurfaceVoxels voxels(workspace, shared_kernels(device()),
                         kernel_config(packed.features, packed.stack_size, settings), across);
    WaveQueue queue(workspace);
    voxels.build(queue);
    queue.drain();
    return {voxels.grid(), download<std::uint32_t>(voxels.words(), voxels.grid().words)};
  }
  Levels levels_of(Scene scene, std::uint32_t across) {
    const View view = resolve_view(scene, {}, 8, 8);
    return levels_of(pack(scene), view, across);
  }
};

// Triangles of all sizes, slivers too, and a box, whose edges are seen end-on: once as they are and once turned and
// mirrored, once turned about an axis. None of the voxels that they meet
// may lack; those marked meet the triangle within a hundredth of a voxel, which is for rounding.
TEST_F(VoxelsTest, MarksWhatTrianglesMeetAndNothingElse) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  std::vector<glm::vec3> soup;
  for (int t = 0; t < 300; ++t) {
    const glm::vec3 at(unit(random), unit(random), unit(random));
    const float size = t < 4 ? 1.5f : std::pow(10.0f, 1.5f * unit(random) - 1.5f);
    for (int corner = 0; corner < 3; ++corner)
      soup.push_back(at + size * glm::vec3(unit(random), unit(random), unit(random)));
  }
  Scene scene = scene_of({soup});
  add_instance(scene, 0,
               glm::translate(glm::dmat4(1.0), glm::dvec3(1.0, 0.5, 0.0)) *
                   glm::rotate(glm::dmat4(1.0), 0.7, glm::dvec3(1.0, 2.0, 3.0)) *
                   glm::scale(glm::dmat4(1.0), glm::dvec3(-0.7, 0.9, 1.1)));
  add_instance(scene, add_mesh(scene, box({0, 0, 0}, {1, 0.5f, 1})),
               glm::rotate(glm::dmat4(1.0), 0.5, glm::dvec3(0, 1, 0)));
  const View view = resolve_view(scene, {}, 8, 8);
  const PackedScene packed = pack(scene);
  const Levels levels = levels_of(packed, view, 48);
  const SurfaceGrid& grid = levels.grid;
  ASSERT_EQ(std::max({levels.size(0).x, levels.size(0).y, levels.size(0).z}), 48);
  std::vector<std::uint8_t> met(static_cast<std::size_t>(levels.size(0).x) * levels.size(0).y * levels.size(0).z),
      nearly = met;
  for (const Draw& draw : packed.draws)
    for (std::uint32_t i = 0; i < draw.instance_count; ++i)
      for_each_triangle(packed, draw, [&](std::uint32_t t) {
        auto corners = placed_corners(packed.triangles[t], instance_of(packed, draw.first_instance + i));
        for (glm::dvec3& p : corners) {
          p = (p - grid.lo) / grid.voxel;
          ASSERT_TRUE(levels.contains(0, glm::ivec3(glm::floor(p))));
        }
        const glm::dvec3 lo = glm::min(glm::min(corners[0], corners[1]), corners[2]) - 1.5,
                         hi = glm::max(glm::max(corners[0], corners[1]), corners[2]) + 1.5;
        const glm::ivec3 first = glm::max(glm::ivec3(glm::floor(lo)), glm::ivec3(0)),
                         last = glm::min(glm::ivec3(glm::floor(hi)), levels.size(0) - 1);
        for_each_voxel(last - first + 1, [&](const glm::ivec3& offset) {
          const glm::ivec3 voxel = first + offset;
          const glm::dvec3 middle = glm::dvec3(voxel) + 0.5;
          met[levels.index(0, voxel)] |= meet(corners, middle, 0.5);
          nearly[levels.index(0, voxel)] |= meet(corners, middle, 0.51);
        });
      });
  std::size_t missed = 0, extra = 0, marked = 0;
  for_each_voxel(levels.size(0), [&](const glm::ivec3& voxel) {
    const bool is_marked = levels.is_marked(voxel);
    marked += is_marked;
    missed += met[levels.index(0, voxel)] && !is_marked;
    extra += is_marked && !nearly[levels.index(0, voxel)];
  });
  EXPECT_GT(marked, 3000u);
  EXPECT_LT(marked, met.size() / 2);
  EXPECT_EQ(missed, 0u);
  EXPECT_EQ(extra, 0u);
}

// Every level from the one below by hand; 10 bits are rounded to 1/2046.
TEST_F(VoxelsTest, LevelsComposeFrontToBack) {
  const Levels levels = levels_of(bodies(), 61); // an odd number, whose last voxels have no neighbours
  ASSERT_EQ(levels.grid.levels.back(), glm::uvec4(1, 1, 1, levels.grid.words - 1));
  for (std::size_t level = 1; level < levels.grid.levels.size(); ++level)
    for_each_voxel(levels.size(level), [&](const glm::ivec3& voxel) {
      glm::dvec3 opacity(0.0);
      for (int axis = 0; axis < 3; ++axis)
        for (const int u : {0, 1})
          for (const int v : {0, 1}) {
            glm::ivec3 front = 2 * voxel;
            front[(axis + 1) % 3] += u, front[(axis + 2) % 3] += v;
            glm::ivec3 back = front;
            ++back[axis];
            const double a = levels.opacity(level - 1, front)[axis], b = levels.opacity(level - 1, back)[axis];
            opacity[axis] += 0.25 * (a + (1.0 - a) * b);
          }
      for (int axis = 0; axis < 3; ++axis)
        ASSERT_NEAR(levels.opacity(level, voxel)[axis], opacity[axis], 0.51 / 1023.0) << level << " " << axis;
    });
}

// Two opaque halves are opaque: a wall hides what is behind it at every level. From the side, half of each voxel is a
// slice of the wall behind another one, and half is open: a' = (1 - (1 - a)^2) / 2.
TEST_F(VoxelsTest, AWallIsOpaqueAcrossAndThinAlong) {
  const Levels levels =
      levels_of(scene_of({rectangle({0, 0, 0}, {0, 0, 1}, {0, 1, 0}),                 // the wall
                          rectangle({1, 0.9f, 0.9f}, {0, 0.05f, 0}, {0, 0, 0.05f})}), // makes the box deep
                64);
  double side = 1.0;
  for (std::size_t level = 1; level < 5; ++level) { // the wall is in the first voxels, and 64 of them high
    side = 0.5 * (1.0 - (1.0 - side) * (1.0 - side));
    const glm::dvec3 opacity = levels.opacity(level, {0, 1, 1});
    EXPECT_EQ(opacity.x, 1.0) << level;
    EXPECT_NEAR(opacity.y, side, 2e-3) << level;
    EXPECT_NEAR(opacity.z, side, 2e-3) << level;
  }
}

TEST_F(VoxelsTest, SameBitsEveryTime) { EXPECT_EQ(levels_of(bodies(), 100).words, levels_of(bodies(), 100).words); }

TEST_F(VoxelsTest, LampsAreNoSurfaces) {
  const Levels with_lamp = levels_of(lit_by_square(0.25f, 2.5f), 64);
  const int above = static_cast<int>((2.5 - with_lamp.grid.lo.y) / with_lamp.grid.voxel);
  for_each_voxel(with_lamp.size(0), [&](const glm::ivec3& voxel) {
    if (voxel.y == above) {
      ASSERT_FALSE(with_lamp.is_marked(voxel));
    }
  });
}

TEST_F(VoxelsTest, TooManyAreRefusedInOneLine) {
  EXPECT_GT(most_voxel_bytes(1024), 600u << 20);
  EXPECT_LT(most_voxel_bytes(256), 12u << 20);
  DeviceInfo info = device().info();
  if (most_voxel_bytes(1024) < info.max_storage_range) return;
  Scene cube = scene_of({box({0, 0, 0}, {1, 1, 1})});
  try {
    levels_of(cube, 1024);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("use a smaller --voxels"), std::string::npos) << error.what();
  }
}

// ---- ambient occlusion ----------------------------------------------------------------------------------------------

RenderPlan cones(std::string_view technique = "cones", double radius = 100.0) {
  RenderPlan settings;
  settings.integrator = &kAo;
  settings.width = settings.height = 48;
  settings.last_sample = 4;
  settings.filter = gpu::kFilterBox;
  settings.ao_samples = 8;
  settings.ao_radius = radius;
  settings.occlusion = index_of(kOcclusionTechniques.names(), technique);
  return settings;
}

void look_down(Scene& scene, glm::dvec3 at, double half) { scene.cameras = {camera_above(at, half)}; }

double middle_of(const std::vector<float>& picture, const RenderPlan& settings) {
  double sum = 0.0;
  for (std::uint32_t y = settings.height / 2 - 4; y < settings.height / 2 + 4; ++y)
    for (std::uint32_t x = settings.width / 2 - 4; x < settings.width / 2 + 4; ++x)
      sum += picture[y * settings.width + x];
  return sum / 64.0;
}

// A cone never sees the plane that it starts from, however wide it is and however the plane lies in the grid.
TEST_F(VoxelsTest, APlaneIsOpenExactly) {
  for (const double turn : {0.0, 0.3, 0.8}) {
    Scene scene = scene_of({rectangle({0, 0, 0}, {0, 0, 50}, {50, 0, 0})},
                           glm::rotate(glm::dmat4(1.0), turn, glm::dvec3(1.0, 0.4, 0.7)));
    add_instance(scene, add_mesh(scene, box({0, -60, 0}, {1, 1, 1}))); // makes the grid deep
    look_down(scene, {0, 0, 0}, 1.0);
    for (const std::uint32_t samples : {1u, 8u}) {
      RenderPlan settings = cones();
      settings.ao_samples = samples;
      for (const float value : light(scene, settings)) ASSERT_EQ(value, 1.0f) << turn << " " << samples;
    }
  }
}

// What a wall takes of a point on the floor before its middle, at `distance`; as high as 1 and from -`half` to `half`
// (the form factor of a perpendicular rectangle).
double wall_fraction(double distance, double half) {
  const double slant = std::sqrt(distance * distance + 1.0);
  return (std::atan(half / distance) - distance / slant * std::atan(half / slant)) / 3.14159265358979;
}

// Voxels are a quarter as wide as they are far away, and the wall may be anywhere in them: it seems higher and nearer.
TEST_F(VoxelsTest, AWallOnAFloorIsItsFormFactor) {
  for (const float distance : {0.25f, 0.5f, 1.0f}) {
    Scene scene =
        scene_of({rectangle({0, 0, 1}, {0, 0, 1}, {2, 0, 0}), rectangle({0, 0.5f, 0}, {2, 0, 0}, {0, 0.5f, 0})});
    look_down(scene, {0, 0, distance}, 0.05);
    EXPECT_NEAR(middle_of(light(scene, cones()), cones()), 1.0 - wall_fraction(distance, 2.0), 0.08) << distance;
  }
}

TEST_F(VoxelsTest, FinerVoxelsAreNearerToRays) {
  const Scene scene = bodies();
  RenderPlan rays = cones("traced", 1.0);
  rays.ao_samples = 64;
  const std::vector<float> truth = light(scene, rays);
  const auto error = [&](std::uint32_t across) {
    RenderPlan settings = cones("cones", 1.0);
    settings.voxels = across;
    const std::vector<float> ours = light(scene, settings);
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) sum += std::abs(truth[i] - ours[i]);
    return sum / static_cast<double>(truth.size());
  };
  const double coarse = error(32), middle = error(96), fine = error(288);
  RecordProperty("errors", fmt::format("{:.4f} {:.4f} {:.4f}", coarse, middle, fine));
  EXPECT_LT(middle, 0.7 * coarse);
  EXPECT_LT(fine, middle);
}

// A closed room is dark. Walls along the axes of the grid hide everything; others let light through where cones are
// wide, as what two voxels cover together counts as if one stood behind the other at random.
TEST_F(VoxelsTest, ThinWallsLeakWhereTheyAreAtAnAngle) {
  const auto light_in_room = [&](double turn) {
    Scene scene = scene_of({box({0, 0, 0}, {1, 0.5f, 1})}, glm::rotate(glm::dmat4(1.0), turn, glm::dvec3(0, 1, 0)));
    Camera camera = camera_above({0, 0, 0}, 0.7);
    camera.world_from_camera[3] = glm::dvec4(0, 0.4, 0, 1); // below the ceiling
    scene.cameras = {camera};
    const std::vector<float> picture = light(scene, cones()), rays = light(scene, cones("traced"));
    EXPECT_EQ(*std::ranges::max_element(rays), 0.0f);
    return std::accumulate(picture.begin(), picture.end(), 0.0) / static_cast<double>(picture.size());
  };
  const double straight = light_in_room(0.0), turned = light_in_room(0.5);
  RecordProperty("leaks", fmt::format("{:.4f} {:.4f}", straight, turned));
  EXPECT_LT(straight, turned);
  EXPECT_GT(turned, 0.0);
  EXPECT_LT(turned, 0.2);
}

// ---- soft shadows ---------------------------------------------------------------------------------------------------

TEST_F(VoxelsTest, WhatIsUnshadowedIsLitExactly) {
  Scene scene = lit_by_square();
  scene.instances.erase(scene.instances.begin() + 1, scene.instances.begin() + 3); // the bodies
  EXPECT_EQ(light(scene, shadow_settings("cones")), light(scene, shadow_settings("traced")));
}

// The shadow of a square under a square lamp, against rays. Mean error over the light of an unshadowed pixel.
TEST_F(VoxelsTest, TheShadowOfASquareIsNearTheTracedOne) {
  Scene scene = lit_by_square(0.4f, 2.0f);
  scene.instances.erase(scene.instances.begin() + 1, scene.instances.begin() + 3);
  add_instance(scene, add_mesh(scene, rectangle({0, 0.8f, 0}, {0.3f, 0, 0}, {0, 0, 0.3f})));
  look_down(scene, {0, -2.5, 0}, 1.5); // from under the lamp and the square
  RenderPlan truth = shadow_settings("traced");
  truth.width = truth.height = 64;
  truth.shadow_samples = 64;
  RenderPlan ours = truth;
  ours.shadows = index_of(kShadowTechniques.names(), "cones");
  Scene open = scene;
  open.instances.pop_back();
  const std::vector<float> exact = light(scene, truth), cone = light(scene, ours), all = light(open, truth);
  double error = 0.0, dark = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    error += std::abs(exact[i] - cone[i]);
    dark += all[i] - exact[i];
    sum += all[i];
  }
  RecordProperty("error", fmt::format("{:.4f} of {:.4f}", error / sum, dark / sum));
  EXPECT_GT(dark / sum, 0.1);
  EXPECT_LT(error, 0.3 * dark);
}

// ---- what nobody asks for -------------------------------------------------------------------------------------------

TEST_F(VoxelsTest, AreMadeForConesAlone) {
  const auto has_voxels = [](const RenderResult& result) {
    return std::ranges::count(result.stages, kVoxelStage, &StageTime::name) > 0;
  };
  const Scene scene = lit_by_square();
  EXPECT_TRUE(has_voxels(render(scene, shadow_settings("cones"))));
  EXPECT_FALSE(has_voxels(render(scene, shadow_settings("traced"))));
  EXPECT_TRUE(has_voxels(render(scene, cones())));
  EXPECT_FALSE(has_voxels(render(scene, cones("gtao"))));
  RenderPlan settings = cones("gtao");
  EXPECT_TRUE(kAo.items(settings, {}, 0).empty());
  EXPECT_NO_THROW(check_voxel_settings(settings));
  settings.voxels = 64;
  EXPECT_THROW(check_voxel_settings(settings), UsageError);
  settings = cones();
  settings.voxels = 64;
  EXPECT_NO_THROW(check_voxel_settings(settings));
  EXPECT_GT(kAo.items(settings, {}, 0).front().bytes, 0u);
}

} // namespace
} // namespace wavepath::test
