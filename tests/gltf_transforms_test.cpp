// What nodes place: meshes, lights and cameras under any scale, matrices that are affine but for rounding, hidden
// nodes, and instances by any attribute.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/base/error.h"
#include "host/scene/bounds.h"
#include "host/scene/gltf/flat.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "kernels/base/gpu.h"
#include "tests/gltf_checks.h"

namespace wavepath {
namespace {

using test::expect_near;
using test::GltfBuilder;
using test::load;
using test::warning_count;

using json = nlohmann::json;

// Half a turn in four, about x.
const json kAboutX = {std::sqrt(0.5), 0, 0, std::sqrt(0.5)};

// The triangle (0,0,0), (1,0,0), (0,1,0), whose normals lean.
GltfBuilder leaning_triangle() {
  GltfBuilder b = GltfBuilder::triangle();
  b.primitive()["attributes"]["NORMAL"] = b.floats("VEC3", {0.6f, 0, 0.8f, 0.6f, 0, 0.8f, 0.6f, 0, 0.8f});
  return b;
}

// Corners of the only triangle that is left, in world space.
std::vector<glm::dvec3> only_triangle(Scene scene) {
  const PackedScene packed = pack(scene);
  EXPECT_EQ(packed.triangles.size(), 1u);
  if (packed.triangles.size() != 1) return std::vector<glm::dvec3>(3);
  EXPECT_EQ(packed.triangles[0].surface & gpu::kTriangleSmooth, 0u) << "the normal is that of the face";
  const gpu::Triangle& t = packed.triangles[0];
  std::vector<glm::dvec3> corners;
  for (const glm::vec3& v : {t.v0, t.v1, t.v2}) corners.push_back(glm::dvec3(v) + packed.origin);
  return corners;
}

TEST(GltfTransforms, AFlatMeshIsTheSameWhereItsScaleIsZeroAcross) {
  GltfBuilder b = leaning_triangle();
  b.root["nodes"][0]["scale"] = {1, 1, 0};
  const Scene scene = load(b);
  EXPECT_TRUE(scene.warnings.empty());
  const auto corners = only_triangle(scene);
  expect_near(corners[0], {0, 0, 0});
  expect_near(corners[1], {1, 0, 0});
  expect_near(corners[2], {0, 1, 0});
}

// Which side is the front is as if the scale were not zero but small.
TEST(GltfTransforms, AFlatMeshKeepsItsFront) {
  const auto normal = [](const glm::dvec3& scale) {
    GltfBuilder b = leaning_triangle();
    b.root["nodes"][0]["scale"] = {scale.x, scale.y, scale.z};
    const Scene scene = load(b);
    const glm::dmat4& place = scene.instances.at(0).world_from_object;
    const auto corners = only_triangle(scene);
    EXPECT_LE(glm::length(glm::cross(glm::dvec3(place[0]), {scale.x, 0, 0})), 1e-12);
    return glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
  };
  for (const double x : {-2.0, -1.0, 1.0})
    for (const double y : {-1.0, 0.5})
      for (const double z : {0.0, 1e-20}) expect_near(normal({x, y, z}), {0, 0, 1});
}

TEST(GltfTransforms, MirroredFlatInstancesKeepTheirFronts) {
  GltfBuilder b = leaning_triangle();
  b.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"SCALE", b.floats("VEC3", {1, 1, 0, -1, 1, 0, 1, -1, 0, -1, -1, 0})}};
  const Scene scene = load(b);
  ASSERT_EQ(scene.instances.size(), 4u);
  for (const Instance& instance : scene.instances) expect_near(instance.world_from_object[2], {0, 0, 1});
  EXPECT_EQ(scene.meshes.size(), 2u);
}

// The corners of the scaled triangle are those of the formula.
TEST(GltfTransforms, FlatScalesOfEveryKind) {
  const auto turn = glm::rotate(glm::dmat4(1.0), 0.7, glm::normalize(glm::dvec3(1, 2, 3)));
  const auto back = glm::rotate(glm::dmat4(1.0), -1.1, glm::normalize(glm::dvec3(3, -1, 1)));
  const auto scale = [](double x, double y, double z) { return glm::scale(glm::dmat4(1.0), {x, y, z}); };
  const auto move = glm::translate(glm::dmat4(1.0), glm::dvec3(3, 4, 5));
  const std::vector<glm::dmat4> chain[] = {
      {scale(2, 3, 0)},
      {scale(-1, 1, 0)},
      {move, scale(1e-3, 1e3, 0)},
      {turn, scale(1, 1, 0)},
      {scale(1, 0, 1), turn},
      {move, scale(0, 2, 1), turn, scale(1, 4, 1), back},
      {turn, scale(1, 1, 0), back, scale(1, 1, 0)},
      {scale(1, 0, 1), turn, scale(1, -1, 1)},
      {scale(1e6, 0, 1e6), back},
      {scale(1, 1, 1e-20)},
  };
  for (std::size_t i = 0; i < std::size(chain); ++i) {
    GltfBuilder b = leaning_triangle();
    glm::dmat4 world(1.0);
    b.root["scenes"] = {{{"nodes", {1}}}};
    for (std::size_t k = 0; k < chain[i].size(); ++k) {
      world *= chain[i][k];
      json matrix = json::array();
      for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) matrix.push_back(chain[i][k][column][row]);
      b.add("nodes", {{"matrix", matrix}, {"children", {k + 1 < chain[i].size() ? static_cast<int>(k) + 2 : 0}}});
    }
    const Scene scene = load(b);
    EXPECT_TRUE(scene.warnings.empty()) << i;
    ASSERT_EQ(scene.instances.size(), 1u) << i;
    EXPECT_EQ(gltf::extent_of(glm::dmat3(scene.instances[0].world_from_object)), gltf::Extent::solid) << i;
    auto corners = only_triangle(scene);
    if (glm::determinant(glm::dmat3(scene.instances[0].world_from_object)) < 0.0) std::swap(corners[1], corners[2]);
    const double size = glm::length(glm::dvec3(world[0])) + glm::length(glm::dvec3(world[1])) + 10.0;
    expect_near(corners[0], world * glm::dvec4(0, 0, 0, 1), 1e-6 * size);
    expect_near(corners[1], world * glm::dvec4(1, 0, 0, 1), 1e-6 * size);
    expect_near(corners[2], world * glm::dvec4(0, 1, 0, 1), 1e-6 * size);
  }
}

TEST(GltfTransforms, WhatHasNoAreaIsLeftOutAndTold) {
  GltfBuilder b = GltfBuilder::triangle();
  for (const json& scale : {json{0, 0, 0}, json{2, 0, 0}, json{0, 0, 3}, json{1e-200, 1e-200, 1e-200}})
    b.add("nodes", {{"mesh", 0}, {"scale", scale}});
  b.add("nodes", {{"mesh", 0}, {"scale", {1e200, 1e200, 1e200}}});
  const Scene scene = load(b);
  EXPECT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(warning_count(scene, "instance with a scale of zero area"), 4u);
  EXPECT_EQ(warning_count(scene, "not affine or not finite"), 1u);
}

TEST(GltfTransforms, FlatInstancesAreFlatInWorldSpace) {
  GltfBuilder b = leaning_triangle();
  const auto h = static_cast<float>(std::sqrt(0.5));
  b.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", b.floats("VEC3", {0, 0, 0, 0, 5, 0, 0, 9, 0, 0, 20, 0})},
      {"ROTATION", b.floats("VEC4", {0, 0, 0, 1, h, 0, 0, h, 0, 0, 0, 1, 0, 0, 0, 1})},
      {"SCALE", b.floats("VEC3", {1, 1, 0, 2, 2, 0, 1, 1, 1, 0, 0, 0})}};
  Scene scene = load(b);
  ASSERT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(warning_count(scene, "zero area"), 1u);
  EXPECT_EQ(scene.instances[0].mesh, scene.instances[1].mesh) << "one flattened mesh";
  EXPECT_NE(scene.instances[0].mesh, scene.instances[2].mesh);
  const auto corner = [&](std::size_t i) {
    const Instance& instance = scene.instances[i];
    return glm::dvec3(instance.world_from_object * glm::dvec4(scene.meshes[instance.mesh].positions[2], 1.0));
  };
  expect_near(corner(0), {0, 1, 0});
  expect_near(corner(1), {0, 5, 2});
  expect_near(corner(2), {0, 10, 0});
  const PackedScene packed = pack(scene);
  EXPECT_EQ(packed.triangle_count, 3u);
  EXPECT_TRUE(warning_count(scene, "dropped") == 0u);
}

// A tetrahedron on z = 0 loses its height.
TEST(GltfTransforms, SolidsBecomeFlat) {
  GltfBuilder b;
  b.mesh_node({{"POSITION", b.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1})}},
              {{"indices", b.accessor<std::uint16_t>("SCALAR", test::kUshort, {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3})}});
  b.root["nodes"][0]["rotation"] = kAboutX;
  b.root["nodes"][0]["scale"] = {1, 1, 0};
  Scene scene = load(b);
  const Bounds box = world_bounds(scene);
  expect_near(box.hi - box.lo, {1, 0, 1});
  EXPECT_EQ(pack(scene).triangle_count, 2u) << "the two walls on the axes have no area left";
}

TEST(GltfTransforms, AnimatedScalesPassZero) {
  GltfBuilder b = leaning_triangle();
  b.add("animations",
        {{"name", "move"},
         {"samplers",
          {{{"input", b.floats("SCALAR", {0, 2, 3})}, {"output", b.floats("VEC3", {1, 1, 1, 1, 1, -1, 0, 0, 0})}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "scale"}}}}}}});
  expect_near(only_triangle(load(b, {"", "move", 1.0}))[2], {0, 1, 0});
  EXPECT_EQ(load(b, {"", "move", 3.0}).instances.size(), 0u);
  // While the shutter is open it may pass zero, or begin and end there.
  for (const auto& shutter : {std::pair{0.5, 1.0}, std::pair{1.0, 1.5}, std::pair{2.5, 3.0}}) {
    LoadOptions options{"", "move", 0.0};
    options.shutter = shutter;
    Scene scene = load(b, options);
    ASSERT_EQ(scene.instances.size(), 1u) << shutter.first;
    EXPECT_EQ(pack(scene).triangle_count, 1u) << shutter.first;
  }
}

TEST(GltfTransforms, WhatGrowsFromNothingMoves) {
  GltfBuilder b = leaning_triangle();
  b.add("animations",
        {{"name", "move"},
         {"samplers", {{{"input", b.floats("SCALAR", {0, 1})}, {"output", b.floats("VEC3", {0, 0, 0, 2, 2, 2})}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "scale"}}}}}}});
  LoadOptions options{"", "move", 0.0};
  options.shutter = {0.0, 1.0};
  Scene scene = load(b, options);
  ASSERT_EQ(scene.instances.size(), 1u);
  const Mesh& mesh = scene.meshes[scene.instances[0].mesh];
  ASSERT_TRUE(mesh.moves());
  const glm::dmat4& place = scene.instances[0].world_from_object;
  expect_near(place * glm::dvec4(mesh.positions[1], 1.0), {0, 0, 0});
  expect_near(place * glm::dvec4(mesh.end_positions[1], 1.0), {2, 0, 0});
}

// ---- Matrices

TEST(GltfTransforms, MatricesThatAreAffineButForRoundingAreAffine) {
  const auto instances = [](double off, std::size_t place) {
    GltfBuilder b = GltfBuilder::triangle();
    std::vector<double> matrix{2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 7, 0, 0, 1};
    matrix[place] += off;
    b.root["nodes"][0]["matrix"] = matrix;
    b.add("nodes", {{"children", {0}}, {"scale", {3, 3, 3}}});
    const Scene scene = load(b);
    if (!scene.instances.empty()) {
      expect_near(scene.instances[0].world_from_object * glm::dvec4(1, 0, 0, 1), {27, 0, 0}, 1e-9);
    } else {
      EXPECT_EQ(warning_count(scene, "not affine"), 1u);
    }
    return scene.instances.size();
  };
  for (const std::size_t place : {3u, 7u, 11u, 15u}) {
    for (const double off : {0.0, 1e-12, 1e-7, -1e-7, 9e-6, -9e-6}) EXPECT_EQ(instances(off, place), 1u) << off;
    for (const double off : {2e-5, -1.0}) EXPECT_EQ(instances(off, place), 0u) << off;
  }
}

// ---- Lights and cameras

GltfBuilder with_light(const char* type) {
  GltfBuilder b;
  b.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", type}, {"spot", json::object()}}};
  b.add("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  return b;
}

PunctualLight only_light(const GltfBuilder& builder) {
  const Scene scene = load(builder);
  EXPECT_EQ(scene.lights.size(), 1u);
  EXPECT_EQ(warning_count(scene, "light"), 0u);
  return scene.lights.empty() ? PunctualLight{} : scene.lights[0];
}

TEST(GltfTransforms, ALightOfItsOwnScaleIsTheSameLight) {
  for (const char* type : {"point", "spot", "directional"})
    for (const json& scale :
         {json{1, 1, 1}, json{0, 0, 0}, json{5, 5, 5}, json{1, 0, 2}, json{1, 1, 0}, json{0, 0, 1}, json{-2, 0, 1},
          json{1e-200, 1e-200, 1e-200}, json{1e200, 1e200, 1e200}, json{3, -1, 2}}) {
      GltfBuilder b = with_light(type);
      b.root["nodes"][0]["translation"] = {1, 2, 3};
      b.root["nodes"][0]["rotation"] = kAboutX; // from -z to +y
      b.root["nodes"][0]["scale"] = scale;
      const PunctualLight light = only_light(b);
      expect_near(light.position, {1, 2, 3});
      expect_near(light.direction, {0, 1, 0}, 1e-12);
      EXPECT_EQ(light.intensity, glm::vec3(1.0f));
    }
}

// A parent's scale counts for the position and, as far as it leaves one, for the orientation.
TEST(GltfTransforms, AParentsScaleMovesAndTurnsALight) {
  const auto light_below = [](const json& scale, const json& rotation) {
    GltfBuilder b = with_light("spot");
    b.root["nodes"][0]["translation"] = {1, 2, 3};
    b.root["nodes"][0]["rotation"] = rotation;
    b.add("nodes", {{"children", {0}}, {"scale", scale}, {"translation", {10, 0, 0}}});
    return only_light(b);
  };
  const json straight = {0, 0, 0, 1}, aslant = {std::sin(0.3), 0, 0, std::cos(0.3)}; // about x by 0.6
  expect_near(light_below({2, 2, 2}, straight).position, {12, 4, 6});
  expect_near(light_below({2, 2, 2}, straight).direction, {0, 0, -1});
  expect_near(light_below({0, 0, 0}, straight).position, {10, 0, 0});
  expect_near(light_below({0, 0, 0}, straight).direction, {0, 0, -1});
  expect_near(light_below({0, 0, 0}, aslant).direction, {0, std::sin(0.6), -std::cos(0.6)}, 1e-12);
  expect_near(light_below({1, 1, 0}, straight).direction, {0, 0, -1});
  expect_near(light_below({1, 1, 0}, aslant).direction, {0, 1, 0}, 1e-12);
  expect_near(light_below({1, 0, 1}, aslant).direction, {0, 0, -1}, 1e-12);
  expect_near(light_below({0, 1, 1}, kAboutX).direction, {0, 1, 0}, 1e-12);
  expect_near(light_below({1, 1, -1}, straight).direction, {0, 0, 1});
  const glm::dvec3 sheared(0, 3 * std::sin(0.6), -std::cos(0.6));
  expect_near(light_below({1, 3, 1}, aslant).direction, glm::normalize(sheared), 1e-12);
}

TEST(GltfTransforms, ALightBelowAFlatMatrixKeepsADirection) {
  GltfBuilder b = with_light("directional");
  b.root["nodes"][0]["matrix"] = {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 1}; // a quarter turn about z, no z
  expect_near(only_light(b).direction, {0, 0, -1});
  b.root["nodes"][0]["matrix"] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 1};
  expect_near(only_light(b).direction, {0, 0, -1});
  expect_near(only_light(b).position, {1, 2, 3});
}

TEST(GltfTransforms, AnAnimatedScaleOfZeroKeepsTheLight) {
  GltfBuilder b = with_light("point");
  b.root["nodes"][0]["translation"] = {0, 0, 2};
  b.add("animations",
        {{"name", "move"},
         {"samplers", {{{"input", b.floats("SCALAR", {0, 1})}, {"output", b.floats("VEC3", {1, 1, 1, 0, 0, 0})}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "scale"}}}}}}});
  for (const double seconds : {0.0, 0.5, 1.0}) {
    const Scene scene = load(b, {"", "move", seconds});
    ASSERT_EQ(scene.lights.size(), 1u) << seconds;
    expect_near(scene.lights[0].position, {0, 0, 2});
  }
}

TEST(GltfTransforms, ACameraOfAnyScaleSeesTheSame) {
  for (const json& scale : {json{1, 1, 1}, json{0, 0, 0}, json{1, 0, 1}, json{4, 4, 4}, json{0, 1, 0}}) {
    GltfBuilder b;
    b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}});
    b.add("nodes", {{"camera", 0}, {"translation", {1, 2, 3}}, {"rotation", kAboutX}, {"scale", scale}});
    const Scene scene = load(b);
    ASSERT_EQ(scene.cameras.size(), 1u);
    const View view = resolve_view(scene, {}, 100, 100);
    expect_near(view.position, {1, 2, 3});
    expect_near(view.forward, {0, 1, 0}, 1e-12);
    expect_near(glm::normalize(view.up), {0, 0, 1}, 1e-12);
  }
}

// ---- KHR_node_visibility

TEST(GltfTransforms, HiddenNodesHideAllBelowThemButCameras) {
  GltfBuilder b = with_light("point"); // node 0
  b.add("meshes",
        {{"primitives",
          {{{"attributes", {{"POSITION", b.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})}}}, {"material", 0}}}}});
  b.add("materials", {{"name", "of a hidden mesh"}});
  b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}});
  const json shown = {{"KHR_node_visibility", {{"visible", true}}}},
             hidden = {{"KHR_node_visibility", {{"visible", false}}}};
  b.add("nodes", {{"mesh", 0}, {"extensions", shown}});                     // 1: below a hidden node
  b.add("nodes", {{"camera", 0}});                                          // 2: likewise
  b.add("nodes", {{"children", {0, 1, 2}}});                                // 3
  b.add("nodes", {{"children", {3}}, {"mesh", 0}, {"extensions", hidden}}); // 4
  b.root["extensionsUsed"] = {"KHR_node_visibility", "KHR_lights_punctual"};
  b.root["extensionsRequired"] = {"KHR_node_visibility"};
  Scene scene = load(b);
  EXPECT_EQ(warning_count(scene, "extension"), 0u);
  EXPECT_EQ(warning_count(scene, "shows no mesh"), 1u);
  EXPECT_TRUE(scene.instances.empty());
  EXPECT_TRUE(scene.lights.empty());
  EXPECT_TRUE(scene.meshes.empty());
  EXPECT_TRUE(scene.materials.empty());
  EXPECT_EQ(scene.cameras.size(), 1u) << "visibility affects no cameras";
  for (const json& visible : {shown, json{{"KHR_node_visibility", json::object()}}}) {
    b.root["nodes"][4]["extensions"] = visible;
    scene = load(b);
    EXPECT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.lights.size(), 1u);
  }
  b.root["nodes"][4]["extensions"]["KHR_node_visibility"]["visible"] = 0;
  EXPECT_THROW(load(b), Error);
}

// The joints of a skin may be hidden, its mesh is what is seen.
TEST(GltfTransforms, HiddenJointsMoveAVisibleMesh) {
  GltfBuilder b = test::full();
  b.root["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"] = false;
  EXPECT_EQ(load(b).instances.size(), 1u);
  b.root["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = false;
  EXPECT_EQ(load(b).instances.size(), 0u);
}

// ---- EXT_mesh_gpu_instancing

TEST(GltfTransforms, GpuInstancing) {
  GltfBuilder b = GltfBuilder::triangle();
  b.root["nodes"][0]["translation"] = {10, 0, 0};
  b.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", b.floats("VEC3", {0, 0, 0, 0, 5, 0})},
      {"ROTATION", b.accessor<std::int8_t>("VEC4", test::kByte, {0, 0, 0, 127, 0, 0, 127, 0}, true)},
      {"SCALE", b.floats("VEC3", {1, 1, 1, 2, 2, 2})}};
  const Scene scene = load(b);
  EXPECT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 2u);
  expect_near(scene.instances[0].world_from_object * glm::dvec4(1, 0, 0, 1), {11, 0, 0});
  expect_near(scene.instances[1].world_from_object * glm::dvec4(1, 0, 0, 1), {8, 5, 0}); // half a turn about z
}

TEST(GltfTransforms, InstancesAreCountedByAnyAttribute) {
  const auto load_with = [](GltfBuilder b, const json& attributes) {
    b.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
    return load(b);
  };
  GltfBuilder b = GltfBuilder::triangle();
  const int three = b.floats("VEC3", {1, 1, 1, 1, 1, 1, 1, 1, 1}), turns = b.floats("VEC4", {0, 0, 0, 1, 0, 0, 0, 1});
  const int ids = b.floats("SCALAR", {7, 8, 9}), bytes = b.accessor<std::uint8_t>("SCALAR", test::kUbyte, {5});
  EXPECT_EQ(load_with(b, {{"_ID", ids}}).instances.size(), 3u);
  EXPECT_EQ(load_with(b, {{"_ID", bytes}}).instances.size(), 1u);
  EXPECT_EQ(load_with(b, {{"TRANSLATION", three}}).instances.size(), 3u);
  EXPECT_EQ(load_with(b, {{"ROTATION", turns}}).instances.size(), 2u);
  EXPECT_EQ(load_with(b, {{"SCALE", three}, {"_ID", ids}, {"_OTHER", three}}).instances.size(), 3u);
  const Scene none = load_with(b, json::object());
  EXPECT_EQ(none.instances.size(), 1u) << "the mesh itself";
  EXPECT_EQ(warning_count(none, "without attributes"), 1u);
  for (const json& wrong : {json{{"_ID", ids}, {"ROTATION", turns}}, json{{"SCALE", three}, {"_ID", bytes}},
                            json{{"TRANSLATION", ids}}, json{{"ROTATION", three}}})
    try {
      load_with(b, wrong);
      ADD_FAILURE() << wrong;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("instance attribute"), std::string::npos) << error.what();
    }
}

} // namespace
} // namespace wavepath
