// Volumes of scenes: those that flags add, those of nodes of glTF files, and how scenes with them are framed.
#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/scene/bounds.h"
#include "host/scene/staging/framing.h"
#include "host/session/load.h"
#include "tests/gltf_checks.h"
#include "tests/volume_files.h"

namespace wavepath {
namespace {

using nlohmann::json;
using test::Coord;
using test::CoordBBox;
using test::expect_near;
using test::GltfBuilder;
using test::warning_count;

// A folder with cloud.nvdb: density 1 for voxels 0 to 15, 0 to 7, 0 to 7, of 0.5 m, and a temperature beside it.
class VolumeScene : public testing::Test {
protected:
  VolumeScene() {
    test::GridSpec density, temperature;
    density.voxel = temperature.voxel = 0.5;
    temperature.name = "temperature";
    const CoordBBox box(Coord(0), Coord(15, 7, 7));
    test::write_grids((folder.path() / "cloud.nvdb").string(), nanovdb::io::Codec::NONE,
                      test::build_grid([](const Coord&) { return 1.0f; }, box, density),
                      test::build_grid([](const Coord&) { return 1500.0f; }, box, temperature));
  }

  std::string cloud() const { return (folder.path() / "cloud.nvdb").string(); }
  std::string write(const GltfBuilder& builder) const { return folder.write("scene.gltf", builder.json()).string(); }
  Scene load(const GltfBuilder& builder, const LoadOptions& options = {}) const {
    return load_gltf(write(builder), options);
  }
  std::string refused(const GltfBuilder& builder) const {
    try {
      load(builder);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  LoadedScene with_flags(const VolumeRequest& volume, const GltfBuilder& builder) const {
    SceneRequest request;
    request.path = write(builder);
    request.volume = volume;
    request.volume.file = cloud();
    return load_scene(request);
  }

  test::TempFolder folder;
};

GltfBuilder node_with(json volume, json node = json::object()) {
  GltfBuilder builder = GltfBuilder::triangle();
  node["extras"]["volume"] = std::move(volume);
  builder.add("nodes", std::move(node));
  return builder;
}

GltfBuilder empty() {
  GltfBuilder builder;
  builder.add("nodes", {{"name", "nothing"}});
  return builder;
}

TEST_F(VolumeScene, NodeWithItsFileAlone) {
  const Scene scene = load(node_with({{"file", "cloud.nvdb"}}));
  ASSERT_TRUE(scene.volume);
  const Volume& volume = *scene.volume;
  EXPECT_EQ(volume.scattering, glm::vec3(1.0f));
  EXPECT_EQ(volume.absorption, glm::vec3(0.0f));
  EXPECT_EQ(volume.anisotropy, 0.0f);
  EXPECT_EQ(volume.emission, 1.0f);
  EXPECT_FALSE(volume.shines());
  EXPECT_EQ(volume.world_from_grid, glm::dmat4(1.0));
  EXPECT_TRUE(volume.grids->temperature);
  EXPECT_EQ(scene.files.back(), cloud());
  EXPECT_TRUE(scene.warnings.empty());
}

TEST_F(VolumeScene, NodeWithEverything) {
  const json values = {
      {"file", "cloud.nvdb"}, {"scattering", {1, 2, 3}}, {"absorption", 0.5},       {"density", 2},
      {"anisotropy", -0.5},   {"emission", 3},           {"temperature_scale", 10}, {"temperature_offset", -273},
      {"colour", 7}};
  const Scene scene = load(node_with(values, {{"translation", {1, 2, 3}}, {"scale", {2, 2, 2}}}));
  ASSERT_TRUE(scene.volume);
  const Volume& volume = *scene.volume;
  EXPECT_EQ(volume.scattering, glm::vec3(2, 4, 6));
  EXPECT_EQ(volume.absorption, glm::vec3(1.0f));
  EXPECT_EQ(volume.anisotropy, -0.5f);
  EXPECT_EQ(volume.emission, 3.0f);
  EXPECT_EQ(volume.temperature_scale, 10.0f);
  EXPECT_EQ(volume.temperature_offset, -273.0f);
  EXPECT_TRUE(volume.shines());
  const Bounds box = volume_bounds(volume); // from half a voxel before the first one on
  expect_near(box.lo, {0.5, 1.5, 2.5});
  expect_near(box.hi, {16.5, 9.5, 10.5});
  EXPECT_EQ(warning_count(scene, "'colour' of the volume of node 1 ignored"), 1u);
}

TEST_F(VolumeScene, ValuesThatNoVolumeHasAreRefused) {
  const auto check = [&](const char* name, const json& value, const std::string& problem) {
    const std::string message = refused(node_with({{"file", "cloud.nvdb"}, {name, value}}));
    EXPECT_NE(message.find("the volume of node 1 has " + std::string(name) + " " + problem), std::string::npos)
        << message;
  };
  check("scattering", {1, 2}, "of 2 numbers instead of three");
  check("scattering", {1, 2, -1}, "-1, which is not within 0 and 1e+09");
  check("absorption", "much", "'\"much\"', which is no number");
  check("anisotropy", 1, "1, which is not within -0.99 and 0.99");
  check("emission", -1, "-1, which is not within");
  check("density", json::array({1}), "'[1]', which is no number");
}

TEST_F(VolumeScene, FilesBesideTheSceneAlone) {
  EXPECT_NE(refused(node_with({{"file", "../cloud.nvdb"}})).find("outside the folder of the file"), std::string::npos);
  EXPECT_NE(refused(node_with({{"file", "fog.nvdb"}})).find("fog.nvdb: cannot be read"), std::string::npos);
  EXPECT_EQ(warning_count(load(node_with({{"path", "cloud.nvdb"}})), "it names no file"), 1u);
  for (const json& other : {json(0.5), json("loud"), json::array()}) {
    const Scene scene = load(node_with(other));
    EXPECT_FALSE(scene.volume);
    EXPECT_TRUE(scene.warnings.empty());
  }
}

TEST_F(VolumeScene, FileOfAnExternalAssetLiesBesideIt) {
  const auto with_scene = [](GltfBuilder builder) {
    builder.root["scenes"] = {{{"nodes", {0, 1}}}};
    builder.root["scene"] = 0;
    return builder;
  };
  folder.write("sub/asset.gltf", with_scene(node_with({{"file", "fog.nvdb"}})).json());
  std::filesystem::rename(cloud(), folder.path() / "sub" / "fog.nvdb");
  GltfBuilder whole = GltfBuilder::triangle();
  whole.root["asset"]["version"] = "2.1";
  whole.root["files"] = {{{"uri", "sub/asset.gltf"}, {"mimeType", "model/gltf+json"}}};
  whole.root["externalAssets"] = {{{"file", 0}}};
  whole.add("nodes", {{"externalAsset", 0}, {"translation", {3, 0, 0}}});
  const Scene scene = load(with_scene(whole));
  ASSERT_TRUE(scene.volume);
  EXPECT_EQ(scene.volume->world_from_grid[3].x, 3.0);
  EXPECT_EQ(scene.files.back(), (folder.path() / "sub" / "fog.nvdb").string());
}

TEST_F(VolumeScene, OneOfThemIsVisible) {
  const json volume = {{"file", "cloud.nvdb"}}, hidden = {{"KHR_node_visibility", {{"visible", false}}}};
  GltfBuilder two = node_with(volume);
  two.add("nodes", {{"extras", {{"volume", volume}}}, {"translation", {5, 0, 0}}});
  EXPECT_NE(refused(two).find("shows two volumes, of nodes 1 and 2"), std::string::npos);
  two.root["nodes"][1]["extensions"] = hidden;
  two.root["extensionsUsed"] = {"KHR_node_visibility"};
  const Scene scene = load(two);
  ASSERT_TRUE(scene.volume);
  EXPECT_EQ(scene.volume->world_from_grid[3].x, 5.0);
  two.root["nodes"][2]["extensions"] = hidden;
  EXPECT_FALSE(load(two).volume);
  EXPECT_FALSE(load(node_with(volume, {{"scale", {1, 0, 1}}})).volume);
}

TEST_F(VolumeScene, FollowsItsNodeFromPoseToPose) {
  GltfBuilder builder = node_with({{"file", "cloud.nvdb"}});
  const int times = builder.floats("SCALAR", {0, 1}), places = builder.floats("VEC3", {0, 0, 0, 4, 0, 0});
  builder.add("animations", {{"samplers", {{{"input", times}, {"output", places}}}},
                             {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}}});
  GltfFile file(write(builder));
  LoadOptions options;
  options.animation = "0";
  Scene scene = file.load(options);
  const auto grids = scene.volume->grids;
  options.at = 0.5;
  scene = file.pose(options, std::move(scene));
  EXPECT_EQ(scene.volume->world_from_grid[3].x, 2.0);
  EXPECT_EQ(scene.volume->grids, grids) << "read again";
  EXPECT_FALSE(file.is_still());
  scene = file.pose(options, std::move(scene));
  EXPECT_TRUE(file.is_still());
  options.shutter = {0.0, 1.0};
  EXPECT_EQ(warning_count(file.pose(options, std::move(scene)), "volume that moves while the shutter is open"), 1u);
}

TEST_F(VolumeScene, FlagsPlaceAndColourIt) {
  VolumeRequest request;
  request.at = {10.0, 20.0, 30.0}, request.size = 2.0;
  request.density = 8.0, request.albedo = {1.0, 0.5, 0.25}, request.anisotropy = 0.5;
  const LoadedScene loaded = with_flags(request, GltfBuilder::triangle());
  ASSERT_TRUE(loaded.scene.volume);
  const Bounds box = volume_bounds(*loaded.scene.volume);
  expect_near(box.lo, {9.0, 19.5, 29.5});
  expect_near(box.hi, {11.0, 20.5, 30.5});
  EXPECT_EQ(loaded.scene.volume->scattering, glm::vec3(8, 4, 2));
  EXPECT_EQ(loaded.scene.volume->absorption, glm::vec3(0, 4, 6));
  EXPECT_EQ(loaded.scene.volume->anisotropy, 0.5f);
  EXPECT_TRUE(loaded.scene.volume->shines());
  EXPECT_EQ(flags_of(request),
            " --volume-at 10,20,30,2 --volume-density 8 --volume-albedo 1,0.5,0.25 --volume-anisotropy 0.5");
}

TEST_F(VolumeScene, FlagsComeBeforeTheFile) {
  const LoadedScene loaded = with_flags({}, node_with({{"file", "missing.nvdb"}}));
  ASSERT_TRUE(loaded.scene.volume);
  EXPECT_EQ(loaded.scene.volume->grids->path, cloud());
  EXPECT_EQ(warning_count(loaded.scene, "volume 'missing.nvdb' of the file replaced by --volume"), 1u);
}

TEST_F(VolumeScene, FlagsHoldFromPoseToPose) {
  SceneRequest request;
  request.path = write(node_with({{"file", "cloud.nvdb"}}));
  request.volume.file = cloud();
  request.volume.at = {1.0, 2.0, 3.0};
  LoadedScene loaded = load_scene(request, {}, true);
  const Volume volume = *loaded.scene.volume;
  EXPECT_TRUE(pose_again(request, loaded));
  EXPECT_EQ(loaded.scene.volume, volume);
}

TEST_F(VolumeScene, FlagsWithoutAVolumeAreRefused) {
  SceneRequest request;
  request.path = write(GltfBuilder::triangle());
  request.volume.density = 3.0;
  EXPECT_THROW(load_scene(request), UsageError);
}

TEST_F(VolumeScene, AloneItFillsThePicture) {
  for (const bool by_flag : {false, true}) {
    const LoadedScene loaded = by_flag ? with_flags({}, empty()) : [&] {
      GltfBuilder builder;
      builder.add("nodes", {{"extras", {{"volume", {{"file", "cloud.nvdb"}}}}}});
      SceneRequest request;
      request.path = write(builder);
      return load_scene(request);
    }();
    expect_near(loaded.framing.bounds.lo, glm::dvec3(-0.25));
    expect_near(loaded.framing.bounds.hi, {7.75, 3.75, 3.75});
    EXPECT_FALSE(loaded.framing.across.empty());
    EXPECT_EQ(warning_count(loaded.scene, "shows no mesh"), 0u);
    const View view = resolve_view(loaded.scene, loaded.framing, {}, 64, 64);
    EXPECT_GT(view.position.z, 4.0); // before it
  }
}

TEST_F(VolumeScene, BoundsHoldMeshAndVolume) {
  const Scene scene = load(node_with({{"file", "cloud.nvdb"}}, {{"translation", {-20, 0, 0}}}));
  const Bounds box = world_bounds(scene);
  expect_near(box.lo, {-20.25, -0.25, -0.25});
  expect_near(box.hi, {1.0, 3.75, 3.75});
}

} // namespace
} // namespace wavepath
